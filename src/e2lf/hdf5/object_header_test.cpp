// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <vector>

#include "e2lf/files/file.h"
#include "e2lf/hdf5/library.h"
#include "testing/test_files.h"

namespace e2lf::hdf5 {
namespace {

/// The bytes of a file with one chunked data set "x", in the oldest format or the latest.
std::vector<uint8_t> chunked_file(bool latest) {
  const TestFolder folder;
  {
    const LibraryLock lock;
    const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    if (latest) H5Pset_libver_bounds(access.get(), H5F_LIBVER_LATEST, H5F_LIBVER_LATEST);
    const Handle file(H5Fcreate((folder / "a.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose);
    const hsize_t extent = 20, chunk = 8;
    const Handle space(H5Screate_simple(1, &extent, nullptr), H5Sclose);
    const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_chunk(properties.get(), 1, &chunk);
    const Handle dataset(
        H5Dcreate2(file.get(), "x", H5T_STD_I32LE, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Dclose);
  }
  return read_file(folder / "a.h5").value();
}

bool opens(std::vector<uint8_t> bytes) {
  const LibraryLock lock;
  const Handle file = open_bytes(std::move(bytes));
  return file.valid() && Handle(H5Dopen2(file.get(), "x", H5P_DEFAULT), H5Dclose).valid();
}

TEST(ObjectHeader, ChunksWithoutADimensionAreRefusedBeforeTheLibraryDividesByZero) {
  auto bytes = chunked_file(false);
  ASSERT_TRUE(opens(bytes));
  // The layout message: version 3, chunked, two dimensions (the second is an element's), an address of 8 bytes, 8, 4.
  size_t found = 0;
  for (size_t i = 0; i + 19 <= bytes.size(); ++i) {
    if (bytes[i] != 3 || bytes[i + 1] != 2 || bytes[i + 2] != 2 || bytes[i + 11] != 8 || bytes[i + 15] != 4) continue;
    bytes[i + 2] = 0;
    ++found;
  }
  ASSERT_EQ(found, 1U);
  EXPECT_FALSE(opens(bytes));
}

TEST(ObjectHeader, OfTheLatestFormatAreReadAsWell) {
  EXPECT_TRUE(opens(chunked_file(true)));
}

TEST(ChunksHaveDimensions, LooksIntoEveryKindOfPiece) {
  const auto layout = [](uint8_t dimensions) { return std::vector<uint8_t>{3, 2, dimensions, 0, 0, 0, 0, 0}; };
  for (const uint8_t dimensions : {uint8_t{0}, uint8_t{2}}) {
    const auto join = [&](std::vector<uint8_t> head) {
      const auto data = layout(dimensions);
      head.insert(head.end(), data.begin(), data.end());
      return head;
    };
    const bool sound = dimensions > 0;
    // Version 1: as a continuation, behind another message; then behind a prefix.
    EXPECT_EQ(chunks_have_dimensions(join({0, 0, 8, 0, 0, 0, 0, 0, 9, 9, 9, 9, 9, 9, 9, 9, 8, 0, 8, 0, 0, 0, 0, 0})),
              sound);
    EXPECT_EQ(chunks_have_dimensions(join({1, 0, 1, 0, 1, 0, 0, 0, 16, 0, 0, 0, 0, 0, 0, 0, 8, 0, 8, 0, 0, 0, 0, 0})),
              sound);
    // Version 2: a header, one with times and creation order, a continuation.
    EXPECT_EQ(chunks_have_dimensions(join({'O', 'H', 'D', 'R', 2, 0, 12, 8, 8, 0, 0})), sound);
    EXPECT_EQ(chunks_have_dimensions(join(
                  {'O', 'H', 'D', 'R', 2, 0x24, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 14, 8, 8, 0, 0, 1, 0})),
              sound);
    EXPECT_EQ(chunks_have_dimensions(join({'O', 'C', 'H', 'K', 8, 8, 0, 0})), sound);
  }
  EXPECT_TRUE(chunks_have_dimensions({}));
}

}  // namespace
}  // namespace e2lf::hdf5
