// SPDX-License-Identifier: MIT
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>

#include "e2lf/files/file.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field_io.h"
#include "testing/test_files.h"
#include "testing/test_light_field.h"

namespace e2lf::lightfield {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

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

TEST_P(MatFile, A13LogicalIsBlackAndWhite) {
  std::vector<size_t> dims = {2, 2, 3, 4};
  std::vector<uint8_t> values(48);
  for (size_t i = 0; i < values.size(); ++i) values[i] = i % 3 == 0 ? 1 : 0;
  mat_t* file = Mat_CreateVer(path_.c_str(), nullptr, GetParam());
  matvar_t* variable = Mat_VarCreate("LF", MAT_C_UINT8, MAT_T_UINT8, static_cast<int>(dims.size()), dims.data(),
                                     values.data(), MAT_F_LOGICAL);
  ASSERT_EQ(Mat_VarWrite(file, variable, MAT_COMPRESSION_NONE), 0);
  Mat_VarFree(variable);
  Mat_Close(file);
  ReadOptions all;
  all.views_y.count = all.views_x.count = 0;
  const auto read = read_light_field(path_, all);
  ASSERT_TRUE(read) << read.error().text();
  EXPECT_EQ(read->at(0, 0, 0, 0), 1.0F);
  EXPECT_EQ(read->at(1, 0, 0, 0), 0.0F);
}

INSTANTIATE_TEST_SUITE_P(Versions, MatFile, testing::Values(MAT_FT_MAT5, MAT_FT_MAT73),
                         [](const auto& version) { return version.param == MAT_FT_MAT5 ? "v5" : "v73"; });

}  // namespace
}  // namespace e2lf::lightfield
