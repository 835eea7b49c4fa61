// SPDX-License-Identifier: MIT
#include <algorithm>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field_io.h"
#include "testing/test_files.h"
#include "testing/test_jpeg.h"
#include "testing/test_log.h"

namespace e2lf::lightfield {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A small picture that says which view it is: value (16 * row + column) / 255 everywhere.
Image labelled_view(size_t row, size_t column, size_t channels = 1) {
  Image image(3, 2, channels);
  std::fill(image.pixels.begin(), image.pixels.end(), static_cast<float>(16 * row + column) / 255.0F);
  return image;
}

float label(size_t row, size_t column) {
  return static_cast<float>(16 * row + column) / 255.0F;
}

std::string two_digits(size_t number) {
  return cat(number / 10, number % 10);
}

void write_grid(const TestFolder& folder, size_t rows, size_t columns,
                const std::function<std::string(size_t row, size_t column)>& name) {
  for (size_t row = 0; row < rows; ++row) {
    for (size_t column = 0; column < columns; ++column) {
      ASSERT_TRUE(write_png(folder / name(row, column), labelled_view(row, column)).ok());
    }
  }
}

std::string view_folder_name(size_t row, size_t column) {
  return two_digits(row) + "_" + two_digits(column) + ".png";
}

TEST(ViewFolder, AcceptsAnyPaddingAndIgnoresOtherFiles) {
  const TestFolder folder;
  write_grid(folder, 8, 8, [](size_t row, size_t column) {
    return row % 2 == 0 ? cat(row, "_", column, ".PNG") : cat("000", row, "_00", column, ".png");
  });
  ASSERT_TRUE(write_file(folder / "run.json", std::string("{}")).ok());
  ASSERT_TRUE(write_file(folder / "0_9_preview.png", std::string("no view")).ok());
  EXPECT_EQ(detect_kind(folder.path()).value(), LightFieldKind::kViewFolder);
  const LightField read = read_light_field(folder.path()).value();
  EXPECT_EQ(read.shape(), (Shape{8, 8, 2, 3, 1}));
  for (size_t row = 0; row < 8; ++row) {
    for (size_t column = 0; column < 8; ++column) EXPECT_EQ(read.at(row, column, 1, 2), label(row, column));
  }
}

ReadOptions every_view() {
  ReadOptions options;
  options.views_y.count = options.views_x.count = 0;
  return options;
}

TEST(ViewFolder, ReadsAnyNamesThatDifferInTwoNumbers) {
  using Name = std::function<std::string(size_t row, size_t column)>;
  const Name names[] = {[](size_t row, size_t column) { return cat("view_", row, "_", column, ".png"); },
                        [](size_t row, size_t column) { return cat("r0", row, "c0", column, ".png"); },
                        [](size_t row, size_t column) { return cat("00", row, "-", column + 1, "_scene.png"); },
                        [](size_t row, size_t column) { return cat("x", column, "_y", row, ".png"); },
                        [](size_t row, size_t column) { return cat("col", column, "row", row, ".png"); }};
  for (const Name& name : names) {
    const TestFolder folder;
    write_grid(folder, 3, 4, name);
    const auto read = read_light_field(folder.path(), every_view());
    ASSERT_TRUE(read) << name(0, 0) << ": " << read.error().text();
    EXPECT_EQ(read->shape(), (Shape{3, 4, 2, 3, 1})) << name(0, 0);
    EXPECT_EQ(read->at(2, 1, 0, 0), label(2, 1)) << name(0, 0);
  }
}

TEST(ViewFolder, ReadsNegativeNumbersInTheirOrder) {
  using Name = std::function<std::string(int row, int column)>;
  const Name names[] = {[](int row, int column) { return cat(row, "_", column, ".png"); },
                        [](int row, int column) { return cat("view_", row, "_", column, ".png"); },
                        [](int row, int column) { return cat("x", column, "_y", row, ".png"); },
                        [](int row, int column) { return cat("view(", row, ",", column, ").png"); },
                        [](int row, int column) { return formatted("v_%+03d_%+03d.png", row, column); },
                        [](int row, int column) { return cat("view-", row + 9, "-", column + 9, ".png"); },
                        [](int row, int column) { return cat("view-", row, "-", column, ".png"); }};
  for (const Name& name : names) {
    const TestFolder folder;
    write_grid(folder, 9, 9, [&name](size_t row, size_t column) {
      return name(static_cast<int>(row) - 4, static_cast<int>(column) - 4);
    });
    const TestLog log;
    const auto read = read_light_field(folder.path(), every_view());
    ASSERT_TRUE(read) << name(-4, 3) << ": " << read.error().text();
    ASSERT_EQ(read->shape(), (Shape{9, 9, 2, 3, 1})) << name(-4, 3);
    for (size_t row = 0; row < 9; ++row) EXPECT_EQ(read->at(row, 8 - row, 0, 0), label(row, 8 - row)) << name(-4, 3);
    EXPECT_THAT(log.text(), testing::Not(HasSubstr("left out"))) << name(-4, 3);
  }
}

TEST(ViewFolder, PicturesInAnotherFormatAreNamed) {
  const TestFolder folder;
  for (const char* name : {"00_00.exr", "00_01.exr", "01_00.EXR", "depth.pfm"}) {
    ASSERT_TRUE(write_file(folder / name, std::string("\x76\x2F\x31\x01")).ok());
  }
  EXPECT_THAT(read_light_field(folder.path()).error().message, HasSubstr("3 pictures as .exr"));
  EXPECT_THAT(unread_pictures_text(folder.path()), HasSubstr("3 pictures as .exr"));
}

TEST(ViewFolder, ImagesThatAreNotReadAreCounted) {
  const TestFolder folder;
  write_grid(folder, 4, 4, [](size_t row, size_t column) { return cat(row, "_", column, ".png"); });
  write_grid(folder, 3, 2, [](size_t row, size_t column) { return cat("m", row + 1, "_", column, ".png"); });
  ASSERT_TRUE(write_png(folder / "mask.png", labelled_view(0, 0)).ok());
  ASSERT_TRUE(write_png(folder / "contact_sheet.png", labelled_view(0, 0)).ok());  // of e2lf itself
  const TestLog log;
  EXPECT_EQ(read_light_field(folder.path(), every_view())->shape(), (Shape{4, 4, 2, 3, 1}));
  EXPECT_THAT(log.text(), testing::AllOf(HasSubstr("left out 6"), HasSubstr("left out 1 image ")));
}

TEST(ViewFolder, TakesNumberedFramesForNoViews) {
  const TestFolder folder;
  write_grid(folder, 1, 8, [](size_t, size_t column) { return cat("2024_frame_", column, ".png"); });
  EXPECT_FALSE(detect_kind(folder.path()));
  const TestFolder incomplete;
  write_grid(incomplete, 3, 3, [](size_t row, size_t column) {
    return cat("a", row + (row + column == 4 ? 9 : 0), "_", column, ".png");
  });
  EXPECT_FALSE(detect_kind(incomplete.path()));
}

TEST(ViewFolder, SaysWhatABrokenViewIs) {
  const TestFolder folder;
  write_grid(folder, 2, 2, view_folder_name);
  ASSERT_TRUE(write_file(folder / "01_01.png", std::string()));
  EXPECT_THAT(read_light_field(folder.path(), every_view()).error().message, HasSubstr("copy it again"));
  ASSERT_TRUE(
      write_file(folder / "01_01.png", std::string("version https://git-lfs.github.com/spec/v1\noid sha256:1")));
  EXPECT_THAT(read_light_field(folder.path(), every_view()).error().message, HasSubstr("git lfs pull"));
}

TEST(ViewFolder, ReadsJpegViews) {
  const TestFolder folder;
  for (size_t view = 0; view < 64; ++view) {
    const std::vector<uint8_t> flat(16 * 8, static_cast<uint8_t>(3 * view));
    const std::string name = two_digits(view / 8) + "_" + two_digits(view % 8) + (view % 2 == 0 ? ".jpg" : ".JPEG");
    ASSERT_TRUE(write_file(folder / name, make_jpeg(flat, 16, 8, 1, JCS_GRAYSCALE)).ok());
  }
  const LightField read = read_light_field(folder.path()).value();
  EXPECT_EQ(read.shape(), (Shape{8, 8, 8, 16, 1}));
  EXPECT_NEAR(read.at(5, 6, 7, 15), 3 * 46 / 255.0F, 1 / 255.0F);
}

TEST(ViewFolder, CountsFromTheSmallestNumber) {
  const TestFolder folder;
  write_grid(folder, 8, 8, [](size_t row, size_t column) { return view_folder_name(row + 1, column + 1); });
  EXPECT_EQ(read_light_field(folder.path()).value().at(7, 6, 0, 0), label(7, 6));
}

TEST(ViewFolder, ColourBecomesGreyOrIsKept) {
  const TestFolder folder;
  Image image(1, 1, 3);
  image.pixels = {1.0F, 0.2F, 0.4F};
  for (size_t view = 0; view < 64; ++view) {
    ASSERT_TRUE(write_png(folder / view_folder_name(view / 8, view % 8), image, PngDepth::k16).ok());
  }
  EXPECT_FLOAT_EQ(read_light_field(folder.path()).value().at(5, 5, 0, 0), grey_of(1.0F, 0.2F, 0.4F));
  ReadOptions options;
  options.colour = true;
  const LightField colour = read_light_field(folder.path(), options).value();
  EXPECT_EQ(colour.shape().channels, 3U);
  EXPECT_FLOAT_EQ(colour.at(5, 5, 0, 0, 2), 0.4F);
}

TEST(ViewFolder, AMissingViewIsNamed) {
  const TestFolder folder;
  write_grid(folder, 8, 8, view_folder_name);
  fs::remove(folder / "03_04.png");
  const Error error = read_light_field(folder.path()).error();
  EXPECT_EQ(error.code, ErrorCode::kNotFound);
  EXPECT_THAT(error.text(), HasSubstr("03_04.png"));
}

TEST(ViewFolder, AViewOfAnotherSizeIsNamed) {
  const TestFolder folder;
  write_grid(folder, 8, 8, view_folder_name);
  ASSERT_TRUE(write_png(folder / "06_01.png", Image(3, 3, 1)).ok());
  const Error error = read_light_field(folder.path()).error();
  EXPECT_EQ(error.code, ErrorCode::kShape);
  EXPECT_THAT(error.text(), testing::AllOf(HasSubstr("06_01.png"), HasSubstr("3x3"), HasSubstr("3x2")));
}

TEST(ViewFolder, AnUnreadableViewIsNamed) {
  const TestFolder folder;
  write_grid(folder, 8, 8, view_folder_name);
  ASSERT_TRUE(write_file(folder / "07_00.png", std::string("garbage, not a picture")).ok());
  EXPECT_EQ(read_light_field(folder.path()).error().code, ErrorCode::kFormat);
  std::vector<uint8_t> bytes = encode_png(labelled_view(2, 2), PngDepth::k8).value();
  bytes.resize(bytes.size() / 2);
  ASSERT_TRUE(write_file(folder / "02_02.png", bytes).ok());
  // Of two errors the one of the first view is reported, whichever thread was faster.
  const Error error = read_light_field(folder.path()).error();
  EXPECT_EQ(error.code, ErrorCode::kTruncated);
  EXPECT_THAT(error.location, HasSubstr("02_02.png"));
}

TEST(ViewFolder, TheSameViewTwiceIsAnError) {
  const TestFolder folder;
  write_grid(folder, 8, 8, view_folder_name);
  ASSERT_TRUE(write_png(folder / "3_4.png", labelled_view(3, 4)).ok());
  EXPECT_EQ(read_light_field(folder.path()).error().code, ErrorCode::kFormat);
}

TEST(ViewFolder, TooFewViewsOrTooMuchMemoryIsAnError) {
  const TestFolder folder;
  write_grid(folder, 5, 8, view_folder_name);
  const Error error = read_light_field(folder.path()).error();
  EXPECT_EQ(error.code, ErrorCode::kShape);
  EXPECT_THAT(error.text(), HasSubstr("5 view rows"));
  ReadOptions options;
  options.views_y.count = 0;
  EXPECT_EQ(read_light_field(folder.path(), options).value().shape(), (Shape{5, 8, 2, 3, 1}));
  options.max_bytes = 5 * 8 * 6 * 4 - 1;
  EXPECT_EQ(read_light_field(folder.path(), options).error().code, ErrorCode::kUnsupported);
}

/// Writes flatly numbered views of a grid; `first` is the number of its first view.
void write_flat(const TestFolder& folder, size_t rows, size_t columns, size_t first, size_t per_row) {
  write_grid(folder, rows, columns,
             [=](size_t row, size_t column) { return cat("input_Cam", first + per_row * row + column, ".png"); });
}

Result<LightField> read_all(const TestFolder& folder, size_t view_columns = 0) {
  ReadOptions options;
  options.views_y.count = options.views_x.count = 0;
  options.view_columns = view_columns;
  return read_light_field(folder.path(), options);
}

TEST(HciFolder, A12SquareGridsOfAnySizeAreFoundFromAnyNumber) {
  for (const size_t side : {1U, 2U, 3U, 5U, 6U, 8U, 11U, 15U}) {
    for (const size_t first : {0U, 1U, 7U}) {
      const TestFolder folder;
      write_flat(folder, side, side, first, side);
      const auto read = read_all(folder);
      ASSERT_TRUE(read) << read.error().text();
      EXPECT_EQ(read->shape(), (Shape{side, side, 2, 3, 1})) << first;
      EXPECT_EQ(read->at(side - 1, 0, 0, 0), label(side - 1, 0));
    }
  }
}

TEST(HciFolder, A12OtherGridsAskForTheirColumns) {
  const TestFolder folder;
  write_flat(folder, 3, 5, 0, 5);
  EXPECT_EQ(read_all(folder).error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(read_all(folder, 5)->shape(), (Shape{3, 5, 2, 3, 1}));
  EXPECT_EQ(read_all(folder, 5)->at(2, 4, 0, 0), label(2, 4));
  const TestFolder part;  // 8x8 views with their numbers in a 9x9 grid
  write_flat(part, 8, 8, 0, 9);
  EXPECT_EQ(read_all(part, 9)->shape(), (Shape{8, 8, 2, 3, 1}));
}

TEST(HciFolder, A12OneMissingViewInTheMiddleIsNamed) {
  const TestFolder folder;
  write_flat(folder, 9, 9, 0, 9);
  fs::remove(folder / "input_Cam40.png");
  EXPECT_THAT(read_all(folder).error().text(), HasSubstr("input_Cam40.png"));
}

TEST(ViewFolder, A12EverySecondViewIsAGrid) {
  const TestFolder folder;
  write_grid(folder, 4, 3, [](size_t row, size_t column) { return cat(2 * row, "_", 3 * column + 1, ".png"); });
  EXPECT_EQ(read_all(folder)->shape(), (Shape{4, 3, 2, 3, 1}));
  EXPECT_EQ(read_all(folder)->at(3, 2, 0, 0), label(3, 2));
}

TEST(ViewFolder, A13WhiteAppliesToViews) {
  const TestFolder folder;
  Image image(1, 2, 1);
  image.pixels = {4095.0F / 65535.0F, 1024.0F / 65535.0F};
  for (size_t view = 0; view < 64; ++view) {
    ASSERT_TRUE(write_png(folder / view_folder_name(view / 8, view % 8), image, PngDepth::k16).ok());
  }
  ReadOptions options;
  options.white = 4095;
  EXPECT_FLOAT_EQ(read_light_field(folder.path(), options)->at(0, 0, 0, 0), 1.0F);
  options.white = 2000;
  EXPECT_THAT(read_light_field(folder.path(), options).error().text(), HasSubstr("4095 at y 0, x 0"));
}

TEST(HciFolder, TakesViewsZeroToSevenOfNine) {
  const TestFolder folder;
  write_grid(folder, 9, 9,
             [](size_t row, size_t column) { return cat("input_Cam0", two_digits(9 * row + column), ".png"); });
  EXPECT_EQ(detect_kind(folder.path()).value(), LightFieldKind::kHciFolder);
  const LightField read = read_light_field(folder.path()).value();
  EXPECT_EQ(read.at(0, 0, 0, 0), label(0, 0));
  EXPECT_EQ(read.at(7, 6, 0, 0), label(7, 6));
  ReadOptions options;
  options.views_y.first = 1;
  options.views_x.count = 0;
  const LightField other = read_light_field(folder.path(), options).value();
  EXPECT_EQ(other.shape(), (Shape{8, 9, 2, 3, 1}));
  EXPECT_EQ(other.at(7, 8, 0, 0), label(8, 8));
  fs::remove(folder / "input_Cam031.png");
  EXPECT_THAT(read_light_field(folder.path()).error().text(), HasSubstr("input_Cam031.png"));
}

TEST(StanfordFolder, TakesASubGridOfSeventeen) {
  const TestFolder folder;
  write_grid(folder, 17, 17, [](size_t row, size_t column) {
    return cat("out_", two_digits(row), "_", two_digits(column), "_-776.8", row, "_1380.5", column, "_.png");
  });
  EXPECT_EQ(detect_kind(folder.path()).value(), LightFieldKind::kStanfordFolder);
  // Row 16 does not fit a label of 8 bits, so the rows stay below.
  const LightField read = read_light_field(folder.path()).value();
  EXPECT_EQ(read.at(0, 0, 0, 0), label(4, 4));
  EXPECT_EQ(read.at(7, 7, 0, 0), label(11, 11));
  ReadOptions options;
  options.views_y.step = options.views_x.step = 2;
  const LightField wide = read_light_field(folder.path(), options).value();
  EXPECT_EQ(wide.at(0, 0, 0, 0), label(1, 1));
  EXPECT_EQ(wide.at(7, 5, 0, 0), label(15, 11));
  options.reverse_rows = true;
  EXPECT_EQ(read_light_field(folder.path(), options).value().at(7, 5, 0, 0), label(1, 11));
}

}  // namespace
}  // namespace e2lf::lightfield
