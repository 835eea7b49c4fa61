// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "e2lf/files/file.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field_io.h"
#include "testing/test_files.h"
#include "testing/test_light_field.h"

namespace e2lf::lightfield {
namespace {

namespace fs = std::filesystem;

struct RoundTripCase {
  LightFieldFormat format;
  LightFieldKind kind;
  const char* name;
  bool colour;
};

class RoundTrip : public testing::TestWithParam<RoundTripCase> {};

TEST_P(RoundTrip, ReadsBackWhatWasWritten) {
  const auto& [format, kind, name, colour] = GetParam();
  const TestFolder folder;
  const LightField written = numbered_light_field({8, 8, 9, 37, colour ? size_t{3} : size_t{1}});
  WriteOptions write_options;
  write_options.format = format;
  const Result<void> status = write_light_field(folder / name, written, write_options);
  ASSERT_TRUE(status.ok()) << status.error().text();

  ReadOptions options;
  options.colour = colour;
  const Result<LightField> read = read_light_field(folder / name, options);
  ASSERT_TRUE(read.ok()) << read.error().text();
  EXPECT_TRUE(same(*read, written));
  EXPECT_EQ(detect_kind(folder / name).value(), kind);
}

INSTANTIATE_TEST_SUITE_P(
    EveryFormat, RoundTrip,
    testing::Values(RoundTripCase{LightFieldFormat::kPng8, LightFieldKind::kViewFolder, "views", false},
                    RoundTripCase{LightFieldFormat::kPng8, LightFieldKind::kViewFolder, "views", true},
                    RoundTripCase{LightFieldFormat::kPng16, LightFieldKind::kViewFolder, "views", false},
                    RoundTripCase{LightFieldFormat::kPng16, LightFieldKind::kViewFolder, "views", true},
                    RoundTripCase{LightFieldFormat::kNpy, LightFieldKind::kNpy, "lf.npy", false},
                    RoundTripCase{LightFieldFormat::kNpy, LightFieldKind::kNpy, "lf.npy", true},
                    RoundTripCase{LightFieldFormat::kHdf5, LightFieldKind::kHdf5, "lf.h5", false}));

TEST(WriteLightField, KeepsValuesOutsideTheRangeInNumbers) {
  const TestFolder folder;
  LightField light_field(Shape{8, 8, 2, 3, 1});
  light_field.at(7, 7, 1, 2) = 1.75F;
  light_field.at(0, 1, 0, 0) = -0.25F;
  ReadOptions options;
  options.range = RangePolicy::kKeep;
  for (const char* name : {"lf.npy", "lf.h5"}) {
    WriteOptions write_options;
    write_options.format = format_of_path(name).value();
    ASSERT_TRUE(write_light_field(folder / name, light_field, write_options).ok());
    EXPECT_TRUE(same(read_light_field(folder / name, options).value(), light_field));
    EXPECT_EQ(read_light_field(folder / name).error().code, ErrorCode::kInvalidValue);
  }
}

TEST(WriteLightField, PngViewsAreRoundedAndClamped) {
  const TestFolder folder;
  LightField light_field(Shape{8, 8, 1, 4, 1});
  const float values[] = {-1.0F, 100.4F / 255.0F, 100.6F / 255.0F, 2.0F};
  std::copy(std::begin(values), std::end(values), light_field.view(3, 4).begin());
  ASSERT_TRUE(write_light_field(folder / "views", light_field).ok());
  EXPECT_THAT(to_bytes(read_image(folder / "views/03_04.png").value()).pixels, testing::ElementsAre(0, 100, 101, 255));
}

TEST(WriteLightField, ColourBecomesGreyInHdf5) {
  const TestFolder folder;
  LightField light_field(Shape{8, 8, 1, 1, 3});
  light_field.at(2, 2, 0, 0, 0) = 1.0F;
  WriteOptions options;
  options.format = LightFieldFormat::kHdf5;
  ASSERT_TRUE(write_light_field(folder / "lf.h5", light_field, options).ok());
  EXPECT_FLOAT_EQ(read_light_field(folder / "lf.h5").value().at(2, 2, 0, 0), 0.299F);
}

TEST(WriteLightField, ReportsEveryViewOnce) {
  const TestFolder folder;
  std::vector<size_t> calls;
  const ProgressFn progress = [&calls](size_t done, size_t total) {
    EXPECT_EQ(total, 64U);
    calls.push_back(done);
  };
  ASSERT_TRUE(write_light_field(folder / "views", numbered_light_field({8, 8, 2, 2, 1}), {}, progress).ok());
  EXPECT_EQ(calls.size(), 64U);
  EXPECT_EQ(calls.back(), 64U);
  calls.clear();
  ASSERT_TRUE(read_light_field(folder / "views", {}, progress).ok());
  EXPECT_EQ(calls.back(), 64U);
}

TEST(WriteLightField, LeavesAnExistingOutputAloneUnlessTold) {
  const TestFolder folder;
  const LightField light_field = numbered_light_field({8, 8, 2, 2, 1});
  for (const char* name : {"views", "lf.npy", "lf.h5"}) {
    WriteOptions options;
    options.format = format_of_path(name).value();
    ASSERT_TRUE(write_light_field(folder / name, light_field, options).ok());
    EXPECT_EQ(write_light_field(folder / name, light_field, options).error().code, ErrorCode::kExists) << name;
    options.overwrite = true;
    EXPECT_TRUE(write_light_field(folder / name, light_field, options).ok()) << name;
  }
  // Nothing but the three outputs is left behind.
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 3);
}

TEST(WriteLightField, AnUnwritableOutputIsAnIoError) {
  const TestFolder folder;
  ASSERT_TRUE(write_file(folder / "file", std::string("text")).ok());
  const LightField light_field = numbered_light_field({8, 8, 2, 2, 1});
  for (const char* name : {"file/views", "file/lf.npy", "file/lf.h5"}) {
    WriteOptions options;
    options.format = format_of_path(name).value();
    EXPECT_EQ(write_light_field(folder / name, light_field, options).error().code, ErrorCode::kIo) << name;
  }
}

TEST(Formats, AreFoundByWordAndByPath) {
  EXPECT_EQ(parse_format("png16").value(), LightFieldFormat::kPng16);
  EXPECT_EQ(parse_format("npy").value(), LightFieldFormat::kNpy);
  EXPECT_EQ(parse_format("tiff").error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(format_of_path("a/b.h5").value(), LightFieldFormat::kHdf5);
  EXPECT_EQ(format_of_path("a/b").value(), LightFieldFormat::kPng8);
  EXPECT_EQ(format_of_path("a/b.mat").error().code, ErrorCode::kUnsupported);
}

}  // namespace
}  // namespace e2lf::lightfield
