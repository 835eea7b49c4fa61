// SPDX-License-Identifier: MIT
#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"
#include "e2lf/files/zip.h"
#include "testing/test_files.h"

namespace e2lf {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using Bytes = std::vector<uint8_t>;

NpzArrays some_arrays() {
  std::vector<int16_t> counts(3 * 200 * 300);
  for (size_t i = 0; i < counts.size(); ++i) counts[i] = static_cast<int16_t>(i * i % 7);
  return {{"codes", make_npy<float>({2, 2}, std::vector<float>{0.0F, 0.25F, 0.5F, 1.0F})},
          {"events", make_npy<int16_t>({3, 200, 300}, counts)}};
}

void expect_equal(const NpzArrays& a, const NpzArrays& b) {
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [name, array] : a) {
    ASSERT_TRUE(b.contains(name)) << name;
    EXPECT_EQ(array.shape, b.at(name).shape);
    EXPECT_EQ(array.type, b.at(name).type);
    EXPECT_EQ(array.bytes, b.at(name).bytes);
  }
}

Error npz_error(const Bytes& bytes) {
  const auto arrays = decode_npz(bytes, "test.npz");
  EXPECT_FALSE(arrays.ok());
  return arrays.ok() ? Error{} : arrays.error();
}

/// Offset of the nth occurrence of a four-byte signature.
size_t find_signature(const Bytes& bytes, uint32_t signature) {
  for (size_t i = 0; i + 4 <= bytes.size(); ++i) {
    if (std::memcmp(bytes.data() + i, &signature, 4) == 0) return i;
  }
  ADD_FAILURE() << "no such signature";
  return 0;
}
constexpr uint32_t kDirectoryEntry = 0x02014b50;
constexpr uint32_t kDirectoryEnd = 0x06054b50;

Bytes one_member(bool compress, const std::string& name = "a.npy") {
  ZipWriter writer;
  writer.add(name, encode_npy(make_npy<uint8_t>({1000}, Bytes(1000, 3))), compress);
  return writer.finish();
}

/// Where the directory entry of "a.npy", the first member, keeps its 64-bit sizes and offset.
constexpr size_t kSize = 46 + 5 + 4, kPacked = kSize + 8, kOffset = kSize + 16;

/// Turns an archive of "a.npy" into one without zip64 records, as other programs write it.
Bytes narrow(const Bytes& wide) {
  const size_t entry = find_signature(wide, kDirectoryEntry), data = 30 + 5 + 20;
  Bytes local(wide.begin(), wide.begin() + 35),
      central(wide.begin() + static_cast<ptrdiff_t>(entry), wide.begin() + static_cast<ptrdiff_t>(entry + 51));
  for (size_t i = 0; i < 4; ++i) {
    local[18 + i] = central[20 + i] = wide[entry + kPacked + i];
    local[22 + i] = central[24 + i] = wide[entry + kSize + i];
    central[42 + i] = 0;
  }
  local[28] = central[30] = 0;  // no extra field
  Bytes end(wide.end() - 22, wide.end());
  end[8] = end[10] = 1;
  end[9] = end[11] = 0;
  const uint32_t size = 51, offset = static_cast<uint32_t>(entry - 20);
  std::memcpy(end.data() + 12, &size, 4);
  std::memcpy(end.data() + 16, &offset, 4);
  Bytes archive = local;
  archive.insert(archive.end(), wide.begin() + data, wide.begin() + static_cast<ptrdiff_t>(entry));
  archive.insert(archive.end(), central.begin(), central.end());
  archive.insert(archive.end(), end.begin(), end.end());
  return archive;
}

TEST(Npz, PeekingTellsShapesWithoutTheData) {
  for (const bool compress : {false, true}) {
    const TestFolder folder;
    ASSERT_TRUE(write_npz(folder / "a.npz", some_arrays(), compress).ok());
    const auto arrays = peek_npz(folder / "a.npz");
    ASSERT_TRUE(arrays.ok()) << arrays.error().text();
    ASSERT_EQ(arrays->size(), 2u);
    EXPECT_THAT(arrays->at("events").shape, ElementsAre(3, 200, 300));
    EXPECT_EQ(arrays->at("events").type, "i2");
    EXPECT_TRUE(arrays->at("events").bytes.empty());
  }
}

TEST(Npz, PeekingDoesNotUnpackWhatFollowsTheHeader) {
  const TestFolder folder;
  Bytes archive = encode_npz({{"a", make_npy<int16_t>({300000}, std::vector<int16_t>(300000, 7))}}, false);
  archive[500000] ^= 1U;  // in the middle of the data
  ASSERT_TRUE(write_file(folder / "a.npz", archive).ok());
  EXPECT_FALSE(read_npz(folder / "a.npz").ok());
  EXPECT_TRUE(peek_npz(folder / "a.npz").ok());
}

TEST(Npz, RoundTripsStoredAndDeflated) {
  const NpzArrays arrays = some_arrays();
  for (const bool compress : {false, true}) {
    const auto read = decode_npz(encode_npz(arrays, compress), "x");
    ASSERT_TRUE(read.ok()) << read.error().text();
    expect_equal(arrays, *read);
  }
  EXPECT_LT(encode_npz(arrays, true).size(), encode_npz(arrays, false).size() / 4);
}

TEST(Npz, ReadsArchivesWithoutZip64) {
  const Bytes archive = narrow(one_member(true));
  const auto read = decode_npz(archive, "x");
  ASSERT_TRUE(read.ok()) << read.error().text();
  EXPECT_EQ(read->at("a").bytes, Bytes(1000, 3));
}

TEST(Npz, ReadsAnArchiveWithAComment) {
  Bytes archive = one_member(true);
  const std::string comment = "a comment";
  archive[archive.size() - 2] = static_cast<uint8_t>(comment.size());
  archive.insert(archive.end(), comment.begin(), comment.end());
  EXPECT_TRUE(decode_npz(archive, "x").ok());
}

TEST(Npz, PassesOverMembersThatAreNoArrays) {
  ZipWriter writer;
  writer.add("readme.txt", Bytes{'h', 'i'}, false);
  const auto read = decode_npz(writer.finish(), "x");
  ASSERT_TRUE(read.ok());
  EXPECT_TRUE(read->empty());
}

TEST(Npz, PassesOverTextBesideNumbers) {
  ZipWriter writer;
  Bytes member = encode_npy(make_npy<int32_t>({1}, std::vector<int32_t>{7}));
  const std::string number_type = "<i4", text_type = "<U1";
  std::copy(text_type.begin(), text_type.end(),
            std::search(member.begin(), member.end(), number_type.begin(), number_type.end()));
  writer.add("camera.npy", member, false);
  writer.add("x.npy", encode_npy(make_npy<int32_t>({1}, std::vector<int32_t>{7})), false);
  const auto read = decode_npz(writer.finish(), "x");
  ASSERT_TRUE(read.ok()) << read.error().text();
  EXPECT_EQ(read->size(), 1U);
}

TEST(Npz, EqualArraysGiveEqualBytes) {
  EXPECT_EQ(encode_npz(some_arrays()), encode_npz(some_arrays()));
}

TEST(Npz, RefusesAnUnknownCompression) {
  Bytes archive = one_member(true);
  archive[find_signature(archive, kDirectoryEntry) + 10] = 12;  // bzip2
  const Error error = npz_error(archive);
  EXPECT_EQ(error.code, ErrorCode::kUnsupported);
  EXPECT_EQ(error.location, "test.npz: a.npy");
  EXPECT_THAT(error.message, HasSubstr("method 12"));
}

TEST(Npz, RefusesEncryption) {
  Bytes archive = one_member(true);
  archive[find_signature(archive, kDirectoryEntry) + 8] |= 1;
  EXPECT_EQ(npz_error(archive).code, ErrorCode::kUnsupported);
}

TEST(Npz, NoticesABadChecksum) {
  Bytes stored = one_member(false);
  stored[stored.size() / 2] ^= 1;  // within the data
  EXPECT_EQ(npz_error(stored).code, ErrorCode::kInvalidValue);
  Bytes deflated = one_member(true);
  deflated[find_signature(deflated, kDirectoryEntry) + 16] ^= 1;
  EXPECT_EQ(npz_error(deflated).code, ErrorCode::kInvalidValue);
}

TEST(Npz, RefusesAMemberThatIsThereTwice) {
  ZipWriter writer;
  const Bytes member = encode_npy(make_npy<uint8_t>({1}, Bytes{3}));
  writer.add("a.npy", member, false);
  writer.add("a.npy", member, false);
  const Error error = npz_error(writer.finish());
  EXPECT_EQ(error.code, ErrorCode::kFormat);
  EXPECT_THAT(error.message, HasSubstr("a.npy"));
}

TEST(Npz, RefusesEveryTruncation) {
  for (const bool compress : {false, true}) {
    const Bytes whole = one_member(compress);
    for (size_t size = 0; size < whole.size(); ++size) {
      EXPECT_FALSE(decode_npz(std::span(whole).first(size), "cut.npz").ok()) << size;
    }
    // The directory is lost, yet it begins like an archive.
    EXPECT_EQ(decode_npz(std::span(whole).first(100), "cut.npz").error().code, ErrorCode::kTruncated);
  }
}

TEST(Npz, RefusesEveryDamagedByteOrReadsTheSameArray) {
  // Flipping any one byte may hit a field nobody reads (dates, attributes); it must never change an array silently.
  const Bytes whole = one_member(true);
  const auto expected = decode_npz(whole, "x");
  for (size_t i = 0; i < whole.size(); ++i) {
    Bytes damaged = whole;
    damaged[i] ^= 0xFF;
    const auto read = decode_npz(damaged, "x");
    if (read.ok() && read->contains("a")) {
      EXPECT_EQ(read->at("a").bytes, expected->at("a").bytes) << i;
    }
  }
}

TEST(Npz, DoesNotTrustTheDirectorysSizes) {
  // A directory that claims 4 GB for a member of 1 kB.
  Bytes larger = one_member(true);
  const size_t entry = find_signature(larger, kDirectoryEntry);
  larger[entry + kSize + 3] = 0xF0;
  EXPECT_EQ(npz_error(larger).code, ErrorCode::kFormat);
  // One that claims fewer bytes than there are.
  Bytes smaller = one_member(true);
  smaller[entry + kSize] -= 1;
  EXPECT_EQ(npz_error(smaller).code, ErrorCode::kFormat);
  // A compressed size beyond the end.
  Bytes beyond = one_member(true);
  beyond[entry + kPacked + 3] = 0x70;
  EXPECT_EQ(npz_error(beyond).code, ErrorCode::kTruncated);
}

TEST(Npz, StopsUnpackingWhenTheArraysHeaderDoesNotAccountForTheSize) {
  // 100 MB of zeros behind the header of one element: refused after the first 64 KiB.
  Bytes member = encode_npy(make_npy<uint8_t>({1}, Bytes{3}));
  member.resize(100'000'000);
  ZipWriter writer;
  writer.add("bomb.npy", member, true);
  const Error error = npz_error(writer.finish());
  EXPECT_EQ(error.code, ErrorCode::kFormat);
  EXPECT_THAT(error.message, HasSubstr("100000000"));
}

TEST(Npz, RefusesEntriesThatShareTheirBytes) {
  ZipWriter writer;
  const Bytes member = encode_npy(make_npy<uint8_t>({5000}, Bytes(5000)));
  writer.add("a.npy", member, false);
  writer.add("b.npy", Bytes{}, false);
  Bytes archive = writer.finish();
  // Point the second entry at the first one's data.
  const size_t first = find_signature(archive, kDirectoryEntry);
  const size_t second = first + kOffset + 8;
  std::copy_n(archive.begin() + static_cast<ptrdiff_t>(first + 16), 4,
              archive.begin() + static_cast<ptrdiff_t>(second + 16));
  std::copy_n(archive.begin() + static_cast<ptrdiff_t>(first + kSize), 24,
              archive.begin() + static_cast<ptrdiff_t>(second + kSize));
  const Error error = npz_error(archive);
  EXPECT_EQ(error.code, ErrorCode::kFormat);
  EXPECT_THAT(error.message, HasSubstr("overlap"));
}

TEST(Npz, RefusesFilesThatAreNoArchives) {
  EXPECT_EQ(npz_error({}).code, ErrorCode::kFormat);
  EXPECT_EQ(npz_error(Bytes(500, 0)).code, ErrorCode::kFormat);
}

TEST(Npz, NamesTheMemberInErrors) {
  ZipWriter writer;
  writer.add("text.npy", Bytes{'h', 'e', 'l', 'l', 'o', ' ', 't', 'h', 'e', 'r', 'e'}, true);
  EXPECT_EQ(npz_error(writer.finish()).location, "test.npz: text.npy");
}

TEST(Npz, FilesRoundTrip) {
  const TestFolder folder;
  const NpzArrays arrays = some_arrays();
  ASSERT_TRUE(write_npz(folder / "a.npz", arrays).ok());
  const auto read = read_npz(folder / "a.npz");
  ASSERT_TRUE(read.ok());
  expect_equal(arrays, *read);
  EXPECT_EQ(read_npz(folder / "b.npz").error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace e2lf
