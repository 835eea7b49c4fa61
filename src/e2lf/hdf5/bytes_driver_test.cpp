// SPDX-License-Identifier: MIT
#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>
#include <string_view>

#include "e2lf/files/file.h"
#include "e2lf/hdf5/library.h"
#include "testing/test_files.h"

namespace e2lf::hdf5 {
namespace {

/// A file with a data set "values" of 0 to 999, and a link "other/values" to that of another file.
void write_example(const std::filesystem::path& path, const std::filesystem::path& other) {
  const Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  const hsize_t count = 1000;
  std::vector<int> values(count);
  std::iota(values.begin(), values.end(), 0);
  const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Handle set(H5Dcreate2(file.get(), "values", H5T_NATIVE_INT, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                   H5Dclose);
  H5Dwrite(set.get(), H5T_NATIVE_INT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  const Handle group(H5Gcreate2(file.get(), "other", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  H5Lcreate_external(other.c_str(), "values", group.get(), "values", H5P_DEFAULT, H5P_DEFAULT);
}

int sum_of(hid_t file) {
  std::vector<int> values(1000);
  const Handle set(H5Dopen2(file, "values", H5P_DEFAULT), H5Dclose);
  if (H5Dread(set.get(), H5T_NATIVE_INT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) return -1;
  return std::accumulate(values.begin(), values.end(), 0);
}

TEST(BytesDriver, ReadsAFileAndItsBytes) {
  const TestFolder folder;
  write_example(folder / "a.h5", folder / "b.h5");
  const Handle from_path = open_file(folder / "a.h5");
  const Handle from_bytes = open_bytes(read_file(folder / "a.h5").value());
  EXPECT_EQ(sum_of(from_path.get()), 499500);
  EXPECT_EQ(sum_of(from_bytes.get()), 499500);
  EXPECT_FALSE(open_bytes({}).valid());
  EXPECT_FALSE(open_file(folder.path()).valid());
}

TEST(BytesDriver, OtherFilesAreNotOpened) {
  const TestFolder folder;
  write_example(folder / "a.h5", folder / "b.h5");
  write_example(folder / "b.h5", folder / "a.h5");
  const LibraryLock lock;
  const Handle file = open_file(folder / "a.h5");
  ASSERT_TRUE(file.valid());
  EXPECT_LT(H5Dopen2(file.get(), "other/values", H5P_DEFAULT), 0);
}

TEST(BytesDriver, NamesThatLieNowhereAreAnError) {
  const TestFolder folder;
  write_example(folder / "a.h5", folder / "b.h5");
  std::vector<uint8_t> bytes = read_file(folder / "a.h5").value();
  // The root group's names: signature, version, size, free list, and the address that the library of the time takes for
  // the place of its own empty buffer.
  constexpr std::string_view kHeap = "HEAP";
  constexpr ptrdiff_t kAddressAt = 24;
  const auto heap = std::search(bytes.begin(), bytes.end(), kHeap.begin(), kHeap.end());
  ASSERT_GT(bytes.end() - heap, kAddressAt + 8);
  std::fill_n(heap + kAddressAt, 8, uint8_t{0xFF});
  ASSERT_TRUE(write_file(folder / "c.h5", bytes).ok());
  const LibraryLock lock;
  const Handle from_path = open_file(folder / "c.h5"), from_bytes = open_bytes(bytes);
  EXPECT_LT(H5Lexists(from_path.get(), "values", H5P_DEFAULT), 0);
  EXPECT_LT(H5Lexists(from_bytes.get(), "values", H5P_DEFAULT), 0);
}

}  // namespace
}  // namespace e2lf::hdf5
