// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cstring>
#include <gtest/gtest.h>
#include <zlib.h>

#include "e2lf/files/file.h"
#include "e2lf/hdf5/library.h"
#include "testing/test_files.h"

namespace e2lf::hdf5 {
namespace {

/// Makes a file with one data set "values" of bytes; `change` sets how it is stored.
template <typename Change>
Handle make_set(const std::filesystem::path& path, std::vector<hsize_t> extents, hid_t type, const Change& change) {
  const Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
  const Handle space(H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr), H5Sclose);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  change(properties.get());
  return {H5Dcreate2(file.get(), "values", type, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Dclose};
}

TEST(Storage, ClaimsBeyondWhatTheFileHoldsAreNotBelieved) {
  const TestFolder folder;
  const hsize_t huge = hsize_t{1} << 40;
  const Handle set = make_set(folder / "a.h5", {huge, huge}, H5T_NATIVE_UINT16, [](hid_t) {});
  const auto storage = inspect_storage(set.get(), "a.h5");
  ASSERT_TRUE(storage.ok()) << storage.error().text();
  EXPECT_EQ(storage->claimed_elements(), UINT64_MAX) << "the product overflows";
  EXPECT_EQ(storage->stored_elements, 0u);
  EXPECT_EQ(storage->bytes_each, 2u);
}

TEST(Storage, NoMoreIsStoredThanTheFileHas) {
  const TestFolder folder;
  constexpr uint64_t kCount = 12345, kClaimed = uint64_t{1} << 40;
  make_set(folder / "a.h5", {kCount}, H5T_NATIVE_UINT8,
           [](hid_t properties) { H5Pset_alloc_time(properties, H5D_ALLOC_TIME_EARLY); });
  std::vector<uint8_t> bytes = read_file(folder / "a.h5").value();
  for (size_t i = 0; i + 8 <= bytes.size(); ++i) {  // the extent, and the bytes that the layout says are stored
    uint64_t number = 0;
    std::memcpy(&number, &bytes[i], 8);
    if (number == kCount) std::memcpy(&bytes[i], &kClaimed, 8);
  }
  const Handle file = open_bytes(bytes);
  const Handle set(H5Dopen2(file.get(), "values", H5P_DEFAULT), H5Dclose);
  const auto storage = inspect_storage(set.get(), "a.h5");
  ASSERT_TRUE(storage.ok()) << storage.error().text();
  EXPECT_EQ(storage->claimed_elements(), kClaimed);
  EXPECT_EQ(storage->stored_elements, bytes.size());
}

TEST(Storage, ElementsInsideTheHeaderMustBeThere) {
  const TestFolder folder;
  const uint64_t value = 0x1122334455667788;
  {
    const Handle set = make_set(folder / "a.h5", {1}, H5T_NATIVE_UINT64,
                                [](hid_t properties) { H5Pset_layout(properties, H5D_COMPACT); });
    H5Dwrite(set.get(), H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, &value);
  }
  std::vector<uint8_t> bytes = read_file(folder / "a.h5").value();
  std::array<uint8_t, 8> pattern{};
  std::memcpy(pattern.data(), &value, 8);
  const auto stored = std::search(bytes.begin(), bytes.end(), pattern.begin(), pattern.end());
  ASSERT_NE(stored, bytes.end());
  for (const uint8_t size : {8, 7, 0}) {  // the 16-bit number in front of the elements
    stored[-2] = size;
    const Handle file = open_bytes(bytes);
    const Handle set(H5Dopen2(file.get(), "values", H5P_DEFAULT), H5Dclose);
    EXPECT_EQ(inspect_storage(set.get(), "a.h5").ok(), size == 8) << int{size};
  }
}

TEST(Storage, HugeElementsAreRefused) {
  const TestFolder folder;
  for (const size_t size : {kMaxElementBytes, kMaxElementBytes + 1, size_t{1} << 31}) {
    const Handle type(H5Tcreate(H5T_OPAQUE, size), H5Tclose);
    const Handle set = make_set(folder / "a.h5", {1}, type.get(), [](hid_t) {});
    EXPECT_EQ(inspect_storage(set.get(), "a.h5").ok(), size == kMaxElementBytes) << size;
  }
}

TEST(Storage, HugeChunksAreRefused) {
  const TestFolder folder;
  const Handle set = make_set(folder / "a.h5", {hsize_t{1} << 40}, H5T_NATIVE_UINT64, [](hid_t properties) {
    const hsize_t chunk = kMaxChunkBytes / 8 + 1;
    H5Pset_chunk(properties, 1, &chunk);
  });
  const auto storage = inspect_storage(set.get(), "a.h5");
  ASSERT_FALSE(storage.ok());
  EXPECT_EQ(storage.error().code, ErrorCode::kUnsupported);
}

TEST(Storage, OtherFilesAreNotRead) {
  const TestFolder folder;
  const std::string other = (folder / "secret").string();
  const Handle set = make_set(folder / "a.h5", {16}, H5T_NATIVE_UINT8,
                              [&](hid_t properties) { H5Pset_external(properties, other.c_str(), 0, 16); });
  const auto storage = inspect_storage(set.get(), "a.h5");
  ASSERT_FALSE(storage.ok());
  EXPECT_EQ(storage.error().code, ErrorCode::kUnsupported);
}

TEST(Storage, TextOfAnyLengthIsRefused) {
  const TestFolder folder;
  const Handle type(H5Tvlen_create(H5T_NATIVE_INT), H5Tclose);
  const Handle set = make_set(folder / "a.h5", {4}, type.get(), [](hid_t) {});
  EXPECT_EQ(inspect_storage(set.get(), "a.h5").error().code, ErrorCode::kUnsupported);
}

/// A data set of two chunks of 64 bytes, packed by deflate; the second is made of `bytes` bytes.
Handle make_packed_set(const std::filesystem::path& path, size_t bytes) {
  Handle set = make_set(path, {128}, H5T_NATIVE_UINT8, [](hid_t properties) {
    const hsize_t chunk = 64;
    H5Pset_chunk(properties, 1, &chunk);
    H5Pset_deflate(properties, 6);
  });
  const std::vector<size_t> sizes = {64, bytes};
  for (size_t i = 0; i < sizes.size(); ++i) {
    const std::vector<uint8_t> values(sizes[i], 7);
    std::vector<uint8_t> packed(compressBound(values.size()));
    uLongf size = packed.size();
    EXPECT_EQ(compress(packed.data(), &size, values.data(), values.size()), Z_OK);
    const hsize_t offset = 64 * i;
    EXPECT_GE(H5Dwrite_chunk(set.get(), H5P_DEFAULT, 0, &offset, size, packed.data()), 0);
  }
  return set;
}

TEST(Storage, EveryPackedChunkMustBeWhole) {
  const TestFolder folder;
  for (const size_t bytes : {64, 63, 65, 1, 0}) {
    const Handle set = make_packed_set(folder / "a.h5", bytes);
    const auto storage = inspect_storage(set.get(), "a.h5");
    ASSERT_TRUE(storage.ok());
    EXPECT_EQ(storage->chunk_bytes, 64u);
    EXPECT_EQ(storage->stored_elements, 128u);
    EXPECT_EQ(chunks_are_whole(set.get(), *storage), bytes == 64) << bytes;
    const hsize_t first = 0, second = 64;
    EXPECT_TRUE(chunk_is_whole(set.get(), *storage, &first));
    EXPECT_EQ(chunk_is_whole(set.get(), *storage, &second), bytes == 64) << bytes;
  }
}

TEST(LibraryLock, SilencesTheLibraryAndPutsItsErrorHandlerBack) {
  H5E_auto2_t before = nullptr, after = nullptr;
  void* data = nullptr;
  H5Eget_auto2(H5E_DEFAULT, &before, &data);
  ASSERT_NE(before, nullptr);
  testing::internal::CaptureStderr();
  EXPECT_FALSE(open_file("/nowhere/at/all.h5").valid());
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  H5Eget_auto2(H5E_DEFAULT, &after, &data);
  EXPECT_EQ(before, after);
}

}  // namespace
}  // namespace e2lf::hdf5
