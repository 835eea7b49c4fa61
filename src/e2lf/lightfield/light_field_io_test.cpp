// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/light_field_io.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <map>
#include <matio.h>
#include <zlib.h>

#include "e2lf/base/file.h"
#include "e2lf/base/npy.h"
#include "e2lf/base/test_files.h"
#include "e2lf/base/text.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/test_jpeg.h"
#include "e2lf/lightfield/test_light_field.h"

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

TEST(HciFolder, TakesViewsZeroToSevenOfNine) {
  const TestFolder folder;
  write_grid(folder, 9, 9,
             [](size_t row, size_t column) { return cat("input_Cam0", two_digits(9 * row + column), ".png"); });
  ASSERT_TRUE(write_file(folder / "parameters.cfg", std::string("")).ok());
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

/// Writes `values` (MATLAB order) as variable `name` of class double.
void write_mat(const fs::path& path, mat_ft version, const char* name, std::vector<size_t> dims,
               std::vector<double> values, matio_compression compression) {
  mat_t* file = Mat_CreateVer(path.c_str(), nullptr, version);
  ASSERT_NE(file, nullptr);
  matvar_t* variable = Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, static_cast<int>(dims.size()), dims.data(),
                                     values.data(), MAT_F_DONT_COPY_DATA);
  ASSERT_EQ(Mat_VarWrite(file, variable, compression), 0);
  Mat_VarFree(variable);
  Mat_Close(file);
}

/// (U,V,H,W,C) in column-major order.
std::vector<double> matlab_values(const LightField& light_field) {
  const Shape& shape = light_field.shape();
  std::vector<double> values;
  for (size_t c = 0; c < shape.channels; ++c)
    for (size_t w = 0; w < shape.width; ++w)
      for (size_t h = 0; h < shape.height; ++h)
        for (size_t v = 0; v < shape.views_x; ++v)
          for (size_t u = 0; u < shape.views_y; ++u) values.push_back(light_field.at(u, v, h, w, c));
  return values;
}

class MatFile : public testing::TestWithParam<mat_ft> {
 protected:
  TestFolder folder_;
  fs::path path_ = folder_ / "scene.mat";
};

TEST_P(MatFile, ReadsTheViewsThatBasicLfsrTakes) {
  const LightField stored = numbered_light_field({9, 9, 4, 5, 3});
  write_mat(path_, GetParam(), "LF", {9, 9, 4, 5, 3}, matlab_values(stored), MAT_COMPRESSION_ZLIB);
  EXPECT_EQ(detect_kind(path_).value(), GetParam() == MAT_FT_MAT5 ? LightFieldKind::kMat : LightFieldKind::kHdf5);
  ReadOptions options;
  options.colour = true;
  const Result<LightField> read = read_light_field(path_, options);
  ASSERT_TRUE(read.ok()) << read.error().text();
  EXPECT_EQ(read->shape(), (Shape{8, 8, 4, 5, 3}));
  for (size_t view = 0; view < 64; ++view) {
    EXPECT_THAT(read->view(view / 8, view % 8), testing::ElementsAreArray(stored.view(view / 8, view % 8)));
  }
  const LightField grey = read_light_field(path_).value();
  EXPECT_EQ(grey.at(3, 2, 1, 4), grey_of(stored.at(3, 2, 1, 4, 0), stored.at(3, 2, 1, 4, 1), stored.at(3, 2, 1, 4, 2)));
}

TEST_P(MatFile, ReadsFourAxesAsGrey) {
  const LightField stored = numbered_light_field({8, 8, 3, 2, 1});
  write_mat(path_, GetParam(), "LF", {8, 8, 3, 2}, matlab_values(stored), MAT_COMPRESSION_NONE);
  EXPECT_TRUE(same(read_light_field(path_).value(), stored));
}

TEST_P(MatFile, OtherContentIsAnError) {
  write_mat(path_, GetParam(), "other", {2, 2}, {1, 2, 3, 4}, MAT_COMPRESSION_NONE);
  EXPECT_EQ(read_light_field(path_).error().code, ErrorCode::kNotFound);
  write_mat(path_, GetParam(), "LF", {2, 2}, {1, 2, 3, 4}, MAT_COMPRESSION_NONE);
  EXPECT_EQ(read_light_field(path_).error().code, ErrorCode::kShape);
  const LightField small = numbered_light_field({5, 5, 3, 2, 3});
  write_mat(path_, GetParam(), "LF", {5, 5, 3, 2, 3}, matlab_values(small), MAT_COMPRESSION_NONE);
  EXPECT_EQ(read_light_field(path_).error().code, ErrorCode::kShape);
  std::vector<double> values = matlab_values(numbered_light_field({8, 8, 3, 2, 1}));
  values[17] = std::nan("");
  write_mat(path_, GetParam(), "LF", {8, 8, 3, 2}, values, MAT_COMPRESSION_NONE);
  EXPECT_EQ(read_light_field(path_).error().code, ErrorCode::kInvalidValue);
}

TEST_P(MatFile, ATruncatedFileIsAnErrorAndPrintsNothing) {
  const LightField stored = numbered_light_field({8, 8, 16, 16, 3});
  for (const matio_compression compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
    write_mat(path_, GetParam(), "LF", {8, 8, 16, 16, 3}, matlab_values(stored), compression);
    const std::vector<uint8_t> whole = read_file(path_).value();
    for (const double part : {0.1, 0.5, 0.9}) {
      const auto size = static_cast<size_t>(part * static_cast<double>(whole.size()));
      ASSERT_TRUE(write_file(path_, std::span(whole).first(size)).ok());
      testing::internal::CaptureStderr();
      const Result<LightField> read = read_light_field(path_);
      EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
      ASSERT_FALSE(read.ok()) << part;
      EXPECT_THAT(read.error().location, HasSubstr("scene.mat"));
    }
  }
}

TEST(Mat5, DamageInCompressedDataIsFound) {
  const TestFolder folder;
  const fs::path path = folder / "scene.mat";
  const LightField stored = numbered_light_field({8, 8, 4, 4, 3});
  write_mat(path, MAT_FT_MAT5, "LF", {8, 8, 4, 4, 3}, matlab_values(stored), MAT_COMPRESSION_ZLIB);
  const std::vector<uint8_t> whole = read_file(path).value();
  for (size_t at = 128; at < whole.size(); at += 7) {
    std::vector<uint8_t> bytes = whole;
    bytes[at] ^= 0x5A;
    ASSERT_TRUE(write_file(path, bytes).ok());
    EXPECT_FALSE(read_light_field(path).ok()) << at;
  }
}

TEST(Mat5, FindsTheVariableBehindOthersAndTakesIntegerClasses) {
  const TestFolder folder;
  const fs::path path = folder / "scene.mat";
  const LightField stored = numbered_light_field({8, 8, 2, 3, 1});
  std::vector<uint8_t> bytes;
  for (const double value : matlab_values(stored)) bytes.push_back(static_cast<uint8_t>(value * 255.0 + 0.5));
  std::vector<size_t> dims = {8, 8, 2, 3}, one = {1, 3};
  for (const matio_compression compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
    mat_t* file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
    std::vector<double> depth = {1.5, 2.5, 3.5};
    matvar_t* first = Mat_VarCreate("depth", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, one.data(), depth.data(), 0);
    matvar_t* second = Mat_VarCreate("LF", MAT_C_UINT8, MAT_T_UINT8, 4, dims.data(), bytes.data(), 0);
    ASSERT_EQ(Mat_VarWrite(file, first, compression), 0);
    ASSERT_EQ(Mat_VarWrite(file, second, compression), 0);
    Mat_VarFree(first);
    Mat_VarFree(second);
    Mat_Close(file);
    const Result<LightField> read = read_light_field(path);
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_TRUE(same(*read, stored));
  }
}

TEST(Mat5, WidensValuesThatAreStoredAsASmallerType) {
  // Class double, 1x1x1x2, values 0 and 1 stored as uint8 in a small element, as MATLAB does for whole numbers.
  std::vector<uint8_t> bytes(128, ' ');
  const std::string text = "MATLAB 5.0 MAT-file";
  std::copy(text.begin(), text.end(), bytes.begin());
  bytes[124] = 0x00, bytes[125] = 0x01, bytes[126] = 'I', bytes[127] = 'M';
  const std::vector<uint8_t> variable = {14, 0, 0, 0, 56,  0,   0, 0,                          // matrix
                                         6,  0, 0, 0, 8,   0,   0, 0, 6, 0, 0, 0, 0, 0, 0, 0,  // flags: double
                                         5,  0, 0, 0, 16,  0,   0, 0, 1, 0, 0, 0, 1, 0, 0, 0,  // extents
                                         1,  0, 0, 0, 2,   0,   0, 0,                          //
                                         1,  0, 2, 0, 'L', 'F', 0, 0,                          // name
                                         2,  0, 2, 0, 0,   1,   0, 0};                         // samples
  bytes.insert(bytes.end(), variable.begin(), variable.end());
  const TestFolder folder;
  ASSERT_TRUE(write_file(folder / "a.mat", bytes).ok());
  ReadOptions options;
  options.views_y.count = options.views_x.count = 0;
  const Result<LightField> read = read_light_field(folder / "a.mat", options);
  ASSERT_TRUE(read.ok()) << read.error().text();
  EXPECT_THAT(read->data(), testing::ElementsAre(0.0F, 1.0F));
}

INSTANTIATE_TEST_SUITE_P(Versions, MatFile, testing::Values(MAT_FT_MAT5, MAT_FT_MAT73),
                         [](const auto& version) { return version.param == MAT_FT_MAT5 ? "v5" : "v73"; });

/// One data set of any type.
void write_set(const fs::path& path, const char* name, hid_t type, std::vector<hsize_t> extents, const void* values) {
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t space = H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr);
  const hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  if (values != nullptr) {
    ASSERT_GE(H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), 0);
  }
  H5Dclose(set);
  H5Sclose(space);
  H5Fclose(file);
}

TEST(Hdf5File, ReadsLumaOfBytesAndFloats) {
  const TestFolder folder;
  const LightField stored = numbered_light_field({8, 8, 3, 5, 1});
  std::vector<uint8_t> bytes;
  for (const float value : stored.data()) bytes.push_back(static_cast<uint8_t>(value * 255.0F + 0.5F));
  write_set(folder / "a.h5", "LF_y", H5T_NATIVE_UINT8, {64, 3, 5}, bytes.data());
  EXPECT_TRUE(same(read_light_field(folder / "a.h5").value(), stored));
  const std::vector<double> doubles(stored.data().begin(), stored.data().end());
  write_set(folder / "b.h5", "LF_y", H5T_NATIVE_DOUBLE, {64, 3, 5}, doubles.data());
  EXPECT_TRUE(same(read_light_field(folder / "b.h5").value(), stored));
}

TEST(Hdf5File, ReadsATransposedPatch) {
  const TestFolder folder;
  const LightField stored = numbered_light_field({5, 5, 4, 4, 1});
  std::vector<float> patch;
  for (size_t v = 0; v < 5; ++v)
    for (size_t w = 0; w < 4; ++w)
      for (size_t u = 0; u < 5; ++u)
        for (size_t h = 0; h < 4; ++h) patch.push_back(stored.at(u, v, h, w));
  write_set(folder / "000001.h5", "Hr_SAI_y", H5T_NATIVE_FLOAT, {20, 20}, patch.data());
  ReadOptions options;
  options.patch_views = options.views_y.count = options.views_x.count = 5;
  EXPECT_TRUE(same(read_light_field(folder / "000001.h5", options).value(), stored));
  EXPECT_EQ(read_light_field(folder / "000001.h5").error().code, ErrorCode::kShape);
}

TEST(Hdf5File, OddContentIsAnErrorAndPrintsNothing) {
  const TestFolder folder;
  testing::internal::CaptureStderr();
  const std::vector<int> whole(64 * 6);
  write_set(folder / "a.h5", "LF_y", H5T_NATIVE_INT, {64, 2, 3}, whole.data());
  EXPECT_EQ(read_light_field(folder / "a.h5").error().code, ErrorCode::kUnsupported);
  write_set(folder / "a.h5", "LF_y", H5T_NATIVE_INT, {63, 2, 3}, whole.data());
  EXPECT_EQ(read_light_field(folder / "a.h5").error().code, ErrorCode::kShape);
  // Extents without samples: nothing is allocated on their word.
  write_set(folder / "a.h5", "LF_y", H5T_NATIVE_FLOAT, {64, 2000, 2000}, nullptr);
  EXPECT_EQ(read_light_field(folder / "a.h5").error().code, ErrorCode::kTruncated);
  write_set(folder / "a.h5", "LF_y", H5T_NATIVE_FLOAT, {64, 1'000'000, 1'000'000}, nullptr);
  EXPECT_EQ(read_light_field(folder / "a.h5").error().code, ErrorCode::kUnsupported);
  write_set(folder / "a.h5", "events", H5T_NATIVE_INT, {64, 2, 3}, whole.data());
  EXPECT_EQ(read_light_field(folder / "a.h5").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(detect_kind(folder / "a.h5").error().code, ErrorCode::kUnsupported);
  ASSERT_TRUE(write_file(folder / "b.h5", std::string("\x89HDF\r\n\x1a\n and nothing more")).ok());
  EXPECT_EQ(read_light_field(folder / "b.h5").error().code, ErrorCode::kFormat);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Hdf5File, AChunkSmallerThanTheLayoutSaysIsRefused) {
  const TestFolder folder;
  const hid_t file = H5Fcreate((folder / "a.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t extents[] = {64, 8, 8};
  const hid_t space = H5Screate_simple(3, extents, nullptr);
  const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_chunk(creation, 3, extents);
  H5Pset_deflate(creation, 6);
  const hid_t set = H5Dcreate2(file, "LF_y", H5T_NATIVE_UINT8, space, H5P_DEFAULT, creation, H5P_DEFAULT);
  const std::vector<uint8_t> part(64 * 8 * 4, 7);
  std::vector<uint8_t> packed(part.size());
  uLongf packed_bytes = packed.size();
  ASSERT_EQ(compress(packed.data(), &packed_bytes, part.data(), part.size()), Z_OK);
  const hsize_t offset[] = {0, 0, 0};
  ASSERT_GE(H5Dwrite_chunk(set, H5P_DEFAULT, 0, offset, packed_bytes, packed.data()), 0);
  H5Dclose(set);
  H5Pclose(creation);
  H5Sclose(space);
  H5Fclose(file);
  EXPECT_EQ(read_light_field(folder / "a.h5").error().code, ErrorCode::kTruncated);
}

TEST(Hdf5File, PutsTheErrorHandlerBack) {
  H5E_auto2_t before = nullptr, after = nullptr;
  void* data = nullptr;
  H5Eget_auto2(H5E_DEFAULT, &before, &data);
  ASSERT_NE(before, nullptr);
  const TestFolder folder;
  ASSERT_TRUE(write_file(folder / "b.h5", std::string("\x89HDF\r\n\x1a\n")).ok());
  EXPECT_FALSE(read_light_field(folder / "b.h5").ok());
  H5Eget_auto2(H5E_DEFAULT, &after, &data);
  EXPECT_EQ(before, after);
}

TEST(Lenslet, TakesTheCentralViewsOfFourteen) {
  const TestFolder folder;
  const LightField stored = numbered_light_field({14, 14, 3, 4, 3});
  WriteOptions write_options;
  write_options.format = LightFieldFormat::kLenslet;
  ASSERT_TRUE(write_light_field(folder / "eslf.png", stored, write_options).ok());
  ReadOptions options;
  options.colour = true;
  const LightField read = read_light_field(folder / "eslf.png", options).value();
  EXPECT_EQ(read.shape(), (Shape{8, 8, 3, 4, 3}));
  EXPECT_EQ(read.at(0, 0, 2, 1, 1), stored.at(3, 3, 2, 1, 1));
  EXPECT_EQ(read.at(7, 2, 0, 3, 2), stored.at(10, 5, 0, 3, 2));
  options.lenslet_views = 15;
  EXPECT_EQ(read_light_field(folder / "eslf.png", options).error().code, ErrorCode::kShape);
}

TEST(Npy, ReadsEveryShape) {
  const TestFolder folder;
  const LightField stored = numbered_light_field({8, 8, 3, 5, 1});
  std::vector<uint8_t> bytes;
  for (const float value : stored.data()) bytes.push_back(static_cast<uint8_t>(value * 255.0F + 0.5F));
  const std::vector<std::vector<size_t>> shapes = {{8, 8, 3, 5}, {8, 8, 3, 5, 1}, {64, 3, 5}, {64, 3, 5, 1}};
  for (const auto& shape : shapes) {
    ASSERT_TRUE(write_npy(folder / "a.npy", make_npy<float>(shape, stored.data())).ok());
    EXPECT_TRUE(same(read_light_field(folder / "a.npy").value(), stored)) << shape_text(shape);
    ASSERT_TRUE(write_npy(folder / "a.npy", make_npy<uint8_t>(shape, bytes)).ok());
    EXPECT_TRUE(same(read_light_field(folder / "a.npy").value(), stored)) << shape_text(shape);
  }
}

TEST(Npy, OtherShapesTypesAndNanAreErrors) {
  const TestFolder folder;
  const auto read_as = [&](const NpyArray& array) {
    EXPECT_TRUE(write_npy(folder / "a.npy", array).ok());
    return read_light_field(folder / "a.npy").error().code;
  };
  const std::vector<float> floats(64 * 6);
  EXPECT_EQ(read_as(make_npy<float>({63, 2}, std::span(floats).first(126))), ErrorCode::kShape);
  EXPECT_EQ(read_as(make_npy<float>({3, 64, 2}, floats)), ErrorCode::kShape);
  EXPECT_EQ(read_as(make_npy<float>({4, 16, 2, 3}, floats)), ErrorCode::kShape);
  const std::vector<int32_t> counts(64 * 6);
  EXPECT_EQ(read_as(make_npy<int32_t>({64, 2, 3}, counts)), ErrorCode::kShape);
  EXPECT_EQ(detect_kind(folder / "a.npy").error().code, ErrorCode::kUnsupported);
  std::vector<float> nan = floats;
  nan[100] = std::nanf("");
  EXPECT_EQ(read_as(make_npy<float>({64, 2, 3}, nan)), ErrorCode::kInvalidValue);
  EXPECT_EQ(read_as(make_npy<float>({64, 0, 3}, {})), ErrorCode::kShape);
}

TEST(Npz, FindsTheLightField) {
  const TestFolder folder;
  const LightField stored = numbered_light_field({8, 8, 2, 2, 1});
  const NpyArray array = make_npy<float>({64, 2, 2}, stored.data());
  ASSERT_TRUE(write_npz(folder / "a.npz", {{"whatever", array}}).ok());
  EXPECT_TRUE(same(read_light_field(folder / "a.npz").value(), stored));
  const NpyArray other = make_npy<float>({1}, std::vector<float>{1});
  ASSERT_TRUE(write_npz(folder / "a.npz", {{"LF", array}, {"gain", other}}).ok());
  EXPECT_TRUE(same(read_light_field(folder / "a.npz").value(), stored));
  EXPECT_EQ(detect_kind(folder / "a.npz").value(), LightFieldKind::kNpz);
  ASSERT_TRUE(write_npz(folder / "a.npz", {{"events", array}, {"gain", other}}).ok());
  EXPECT_THAT(read_light_field(folder / "a.npz").error().text(), HasSubstr("events, gain"));
  EXPECT_EQ(detect_kind(folder / "a.npz").error().code, ErrorCode::kUnsupported);
}

TEST(DetectKind, SaysWhatIsNoLightField) {
  const TestFolder folder;
  EXPECT_EQ(detect_kind(folder / "nothing").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(detect_kind(folder.path()).error().code, ErrorCode::kUnsupported);
  ASSERT_TRUE(write_file(folder / "text", std::string("hello")).ok());
  EXPECT_EQ(detect_kind(folder / "text").error().code, ErrorCode::kUnsupported);
  ASSERT_TRUE(write_file(folder / "empty", std::string()).ok());
  EXPECT_EQ(read_light_field(folder / "empty").error().code, ErrorCode::kUnsupported);
}

TEST(RealData, LegoKnightsHasFullRangeGrey) {
  E2LF_REQUIRE_DATA("official/Lego_Knights");
  const LightField read = read_light_field(test_data("official/Lego_Knights")).value();
  EXPECT_EQ(read.shape(), (Shape{8, 8, 512, 512, 1}));
  const auto [low, high] = std::minmax_element(read.data().begin(), read.data().end());
  EXPECT_EQ(*low, 17.0F / 255.0F);
  EXPECT_EQ(*high, 247.0F / 255.0F);
}

TEST(RealData, EverySceneHasItsSize) {
  E2LF_REQUIRE_DATA("lightfields");
  const std::map<std::string, std::pair<size_t, size_t>> scenes = {
      {"hci_cotton", {512, 512}},          {"hci_antinous", {512, 512}},    {"stf_chess_div2", {424, 240}},
      {"stf_jellybeans_div3", {256, 128}}, {"blender_shop_00", {468, 308}}, {"blender_shop_02", {468, 308}},
      {"blender_shop_11", {468, 308}},     {"blender_shop_20", {468, 308}}, {"blender_shop_22", {468, 308}},
      {"lytro_dino2067", {552, 383}},      {"lytro_toy", {625, 434}}};
  for (const auto& [name, size] : scenes) {
    const Result<LightField> read = read_light_field(test_data("lightfields") / name);
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(read->shape(), (Shape{8, 8, size.second, size.first, 1})) << name;
  }
}

}  // namespace
}  // namespace e2lf::lightfield
