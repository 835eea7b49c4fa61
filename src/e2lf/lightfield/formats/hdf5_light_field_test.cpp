// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <utility>
#include <zlib.h>

#include "e2lf/files/file.h"
#include "e2lf/lightfield/light_field_io.h"
#include "testing/test_files.h"
#include "testing/test_light_field.h"

namespace e2lf::lightfield {
namespace {

namespace fs = std::filesystem;

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

/// Views of a textured plane with a disparity of 0.4 px, of which neighbours resemble each other.
LightField textured_views(size_t views, size_t side) {
  LightField field({views, views, side, side, 1});
  for (size_t v = 0; v < views; ++v) {
    for (size_t u = 0; u < views; ++u) {
      for (size_t y = 0; y < side; ++y) {
        for (size_t x = 0; x < side; ++x) {
          const double at_y = static_cast<double>(y) - 0.4 * static_cast<double>(v);
          const double at_x = static_cast<double>(x) - 0.4 * static_cast<double>(u);
          const double value = std::sin(0.31 * at_x + 0.11 * at_y) + std::sin(0.17 * at_y - 0.23 * at_x) +
                               std::sin(0.0013 * at_x * at_y);
          field.view(v, u)[y * side + x] = static_cast<float>(0.5 + value / 6);
        }
      }
    }
  }
  return field;
}

/// Writes a field as BasicLFSR's scripts do: whole views side by side, transposed.
void write_patch(const fs::path& path, const LightField& stored) {
  const Shape& shape = stored.shape();
  std::vector<float> patch;
  for (size_t v = 0; v < shape.views_x; ++v)
    for (size_t w = 0; w < shape.width; ++w)
      for (size_t u = 0; u < shape.views_y; ++u)
        for (size_t h = 0; h < shape.height; ++h) patch.push_back(stored.at(u, v, h, w));
  write_set(path, "Hr_SAI_y", H5T_NATIVE_FLOAT, {shape.views_x * shape.width, shape.views_y * shape.height},
            patch.data());
}

ReadOptions every_view_of(size_t lenslet_views = 0) {
  ReadOptions options;
  options.views_y.count = options.views_x.count = 0;
  options.lenslet_views = lenslet_views;
  return options;
}

TEST(Hdf5File, APatchOfAnyGridIsReadAsItsContentShows) {
  const TestFolder folder;
  for (const auto& [views, side] : std::vector<std::pair<size_t, size_t>>{
           {2, 64}, {4, 64}, {5, 64}, {5, 32}, {6, 64}, {7, 64}, {8, 64}, {8, 32}, {9, 64}, {9, 32}, {16, 32}}) {
    const LightField stored = textured_views(views, side);
    write_patch(folder / "a.h5", stored);
    const auto read = read_light_field(folder / "a.h5", every_view_of());
    ASSERT_TRUE(read.ok()) << views << ": " << read.error().text();
    EXPECT_TRUE(same(*read, stored)) << views << " of " << side;
    EXPECT_TRUE(same(read_light_field(folder / "a.h5", every_view_of(views)).value(), stored)) << views;
  }
  ReadOptions central;
  central.lenslet_views = 16;
  EXPECT_EQ(read_light_field(folder / "a.h5", central)->shape(), (Shape{8, 8, 32, 32, 1}));
}

TEST(Hdf5File, AnotherGridThanThatOfThePatchIsRefused) {
  const TestFolder folder;
  write_patch(folder / "5.h5", textured_views(5, 64));
  write_patch(folder / "8.h5", textured_views(8, 64));
  for (const size_t views : {2, 4, 8, 10, 16}) {
    EXPECT_EQ(read_light_field(folder / "5.h5", every_view_of(views)).error().option, "lenslet_views") << views;
  }
  for (const size_t views : {2, 4, 16}) {
    EXPECT_EQ(read_light_field(folder / "8.h5", every_view_of(views)).error().option, "lenslet_views") << views;
  }
  EXPECT_EQ(read_light_field(folder / "8.h5", every_view_of(5)).error().code, ErrorCode::kShape);
}

TEST(Hdf5File, APatchWhoseContentShowsNoGridNeedsItStated) {
  const TestFolder folder;
  LightField flat({5, 5, 64, 64, 1});
  std::fill(flat.data().begin(), flat.data().end(), 0.5F);
  write_patch(folder / "flat.h5", flat);
  EXPECT_EQ(read_light_field(folder / "flat.h5", every_view_of()).error().option, "lenslet_views");
  EXPECT_EQ(read_light_field(folder / "flat.h5", every_view_of(5))->shape(), (Shape{5, 5, 64, 64, 1}));
}

TEST(Hdf5File, ReadsLfInTheOrderOfMatlabAndOfPython) {
  const TestFolder folder;
  const LightField stored = numbered_light_field({9, 9, 20, 31, 3});
  std::vector<float> matlab;
  for (size_t c = 0; c < 3; ++c)
    for (size_t w = 0; w < 31; ++w)
      for (size_t h = 0; h < 20; ++h)
        for (size_t v = 0; v < 9; ++v)
          for (size_t u = 0; u < 9; ++u) matlab.push_back(stored.at(u, v, h, w, c));
  write_set(folder / "matlab.h5", "LF", H5T_NATIVE_FLOAT, {3, 31, 20, 9, 9}, matlab.data());
  write_set(folder / "python.h5", "LF", H5T_NATIVE_FLOAT, {9, 9, 20, 31, 3}, stored.data().data());
  ReadOptions options;
  options.views_y.count = options.views_x.count = 0;
  options.colour = true;
  for (const char* name : {"matlab.h5", "python.h5"}) {
    EXPECT_TRUE(same(read_light_field(folder / name, options).value(), stored)) << name;
  }
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

}  // namespace
}  // namespace e2lf::lightfield
