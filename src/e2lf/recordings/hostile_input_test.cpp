// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cstring>
#include <gtest/gtest.h>
#include <hdf5.h>

#include "e2lf/files/file.h"
#include "e2lf/files/npy.h"
#include "e2lf/recordings/recording.h"
#include "testing/chunked_source.h"
#include "testing/test_streams.h"

/// Files that lie about themselves, and streams that a format cannot hold: what fuzzing found, and what it looks for.
namespace e2lf::recordings {
namespace {

template <typename T>
NpyArray npy_column(std::vector<T> values) {
  return make_npy<T>({values.size()}, values);
}

Result<EventBatch> read_bytes(std::vector<uint8_t> bytes, const std::string& format) {
  OpenOptions options = {.format = format, .policy = DecodePolicy::kSkip};
  E2LF_ASSIGN_OR_RETURN(auto reader, open_recording(make_memory_source(std::move(bytes)), options));
  return read_all(*reader);
}

TEST(HostileNpz, ColumnsOfDifferentLengthsAreRefusedWhicheverIsShort) {
  for (const char* shortened : {"x", "y", "p", "t", "trigger_t", "trigger_p", "trigger_id"}) {
    NpzArrays arrays;
    for (const char* key : {"x", "y", "p", "t", "trigger_t", "trigger_p", "trigger_id"}) {
      arrays.emplace(key, npy_column<int64_t>(key == std::string(shortened) ? std::vector<int64_t>{}
                                                                            : std::vector<int64_t>{1, 1, 1, 1, 1}));
    }
    const auto batch = read_bytes(encode_npz(arrays), "npz");
    ASSERT_FALSE(batch.ok()) << shortened;
    EXPECT_EQ(batch.error().code, ErrorCode::kShape) << shortened;
  }
}

TEST(HostileNpz, TimesBeyondAnyClockAreDropped) {
  NpzArrays arrays;
  arrays.emplace("t", npy_column<int64_t>({INT64_MIN, 5, 6, INT64_MAX}));
  for (const char* key : {"x", "y", "p"}) arrays.emplace(key, npy_column<int32_t>({1, 1, 1, 1}));
  const Decoded read = decoded(encode_npz(arrays), {.time = TimeOrigin::kZero});
  ASSERT_EQ(read.batch.events.size(), 2u);
  EXPECT_EQ(read.batch.events.t.back(), 1);
  EXPECT_EQ(read.summary.num_violations(), 2u);
}

void put_numbers(hid_t file, const char* name, const std::vector<int64_t>& values) {
  const hsize_t count = values.size();
  const hid_t space = H5Screate_simple(1, &count, nullptr);
  const hid_t set = H5Dcreate2(file, name, H5T_NATIVE_INT64, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(set, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  H5Dclose(set);
  H5Sclose(space);
}

/// A DSEC file whose t_offset holds `count` numbers.
void write_dsec_with_offsets(const std::filesystem::path& path, size_t count, int64_t value) {
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  for (const char* column : {"x", "y", "p"}) put_numbers(file, column, {1, 0, 1});
  put_numbers(file, "t", {5, 6, 7});
  put_numbers(file, "t_offset", std::vector<int64_t>(count, value));
  H5Fclose(file);
}

TEST(HostileDsec, AnOffsetThatIsNotOneTimeIsRefused) {
  TestFolder folder;
  const auto path = folder / "a.h5";
  write_dsec_with_offsets(path, 1, 1000);
  EXPECT_TRUE(open_recording(path).ok());
  write_dsec_with_offsets(path, 1000, 1000);
  EXPECT_EQ(open_recording(path).error().code, ErrorCode::kFormat);
  write_dsec_with_offsets(path, 1, INT64_MAX);
  EXPECT_EQ(open_recording(path).error().code, ErrorCode::kFormat);
}

TEST(DatWriter, RefusesAJumpThatReadsAsAStep) {
  // After the 32-bit clock has wrapped, three quarters of it ahead reads as shortly before the wrap.
  const int64_t wrap_us = int64_t{1} << 32;
  for (const int64_t jump_us : {int64_t{1000}, 3 * wrap_us / 4}) {
    std::vector<uint8_t> bytes;
    auto writer = create_recording(make_memory_sink(bytes), "dat", {.width = 64, .height = 48});
    EventBatch batch;
    for (const int64_t t_us : {wrap_us - 5, wrap_us + 5, wrap_us + 5 + jump_us})
      batch.events.push_back({1, 1, 1, t_us});
    const auto written = (*writer)->write(batch);
    ASSERT_EQ(written.ok(), jump_us == 1000);
    if (!written.ok()) continue;
    EXPECT_EQ(read_bytes(bytes, "dat")->events, batch.events);
  }
}

TEST(Hdf5Writer, RefusesAPauseThatItsIndexWouldHaveToFill) {
  TestFolder folder;
  auto writer = create_recording(folder / "a.hdf5", "", {.width = 64, .height = 48}).value();
  EventBatch batch;
  batch.events.push_back({1, 1, 1, 100});
  batch.events.push_back({1, 1, 1, kTimeLimitUs});
  EXPECT_EQ(writer->write(batch).error().code, ErrorCode::kInvalidValue);
}

TEST(EmptyText, KeepsTheSizeOfTheSensor) {
  for (const auto& [format, text] : {std::pair("csv", "%geometry:640,480\n"), {"txt", "640 480\n"}}) {
    const std::string_view head = text;
    const std::vector<uint8_t> bytes(head.begin(), head.end());
    auto reader = open_bytes(bytes, {.format = format}).value();
    EXPECT_EQ(reader->info().width, 640u) << format;
    EXPECT_TRUE(read_all(*reader).value().empty());
    EXPECT_EQ(reader->summary().num_violations(), 0u) << format;
  }
}

TEST(DatWriter, RefusesCoordinatesThatTheFormatWouldCut) {
  std::vector<uint8_t> bytes;
  auto writer = create_recording(make_memory_sink(bytes), "dat", {.width = 65536, .height = 480});
  EventBatch batch;
  batch.events.push_back({20000, 5, 1, 10});
  EXPECT_EQ((*writer)->write(batch).error().code, ErrorCode::kInvalidValue);
}

TEST(HostileText, ALineThatNeverEndsIsOneBadLineFromAnySource) {
  const std::string text = "1,2,1,5\n" + std::string(9000, 'x') + "3,4,1,6\n5,6,0,7\n";
  const std::vector<uint8_t> bytes(text.begin(), text.end());
  for (const size_t step : {size_t{1}, size_t{4000}, bytes.size()}) {
    const Decoded read = decoded(chunked(bytes, step), {.format = "csv"});
    EXPECT_EQ(read.batch.events.size(), 2u) << step;
    EXPECT_EQ(read.summary.num_violations(), 1u) << step;
  }
}

TEST(HostileText, NamesThatBreakOffAreNoOrderOfColumns) {
  const std::string text = "640 480\nx 1 1 0\n";
  const std::vector<uint8_t> bytes(text.begin(), text.end());
  OpenOptions options = {.format = "txt", .policy = DecodePolicy::kSkip};
  const auto reader = open_bytes(bytes, options);
  ASSERT_FALSE(reader.ok());
  EXPECT_EQ(reader.error().code, ErrorCode::kFormat);
}

TEST(RawWriter, RefusesTriggersThatTheEncodingWouldRename) {
  for (const auto& [format, last_id] : {std::pair("evt3", 15), {"evt2", 31}, {"evt2.1", 31}}) {
    for (const int id : {last_id, last_id + 1}) {
      std::vector<uint8_t> bytes;
      auto writer = create_recording(make_memory_sink(bytes), format, {.width = 64, .height = 48});
      EventBatch batch;
      batch.triggers.push_back({100, static_cast<uint16_t>(id), 1});
      const auto written = (*writer)->write(batch);
      ASSERT_EQ(written.ok(), id == last_id) << format;
      if (!written.ok()) continue;
      EXPECT_EQ(read_bytes(bytes, format)->triggers, batch.triggers) << format;
    }
  }
}

TEST(RawWriter, RefusesAPauseThatItWouldHaveToFill) {
  std::vector<uint8_t> bytes;
  auto writer = create_recording(make_memory_sink(bytes), "evt3", {.width = 64, .height = 48});
  EventBatch batch;
  batch.events.push_back({1, 1, 1, 100});
  batch.events.push_back({1, 1, 1, 100 + (int64_t{1} << 37)});
  EXPECT_EQ((*writer)->write(batch).error().code, ErrorCode::kInvalidValue);
  EXPECT_LT(bytes.size(), 4096u);
}

TEST(HostileEvt21, TheByteOrderIsFoundThoughOneOfTheFirstWordsIsDamaged) {
  EventBatch batch;
  for (int64_t i = 0; i < 400; ++i) batch.events.push_back({12, static_cast<uint16_t>(i % 48), 1, 1000 + i});
  for (const std::string order : {"legacy", "little"}) {
    std::vector<uint8_t> bytes =
        encoded(batch, "evt2.1", {.width = 64, .height = 48, .header = {{"endianness", order}}});
    const std::string key = "endianness=" + order, end = "% end\n";
    std::fill_n(std::search(bytes.begin(), bytes.end(), key.begin(), key.end()), key.size(), uint8_t{'x'});
    // The type of the third word, whichever half it is in.
    const auto words = std::search(bytes.begin(), bytes.end(), end.begin(), end.end()) + 6;
    words[16 + 3] = words[16 + 7] = 0x70;
    const auto events = read_bytes(bytes, "evt2.1").value().events;
    EXPECT_GE(events.size(), 398u) << order;
    EXPECT_TRUE(std::all_of(events.x.begin(), events.x.end(), [](uint16_t x) { return x == 12; })) << order;
  }
}

/// 400 events of the pixels x = 30, y = i % 48 at 1000 + i us, but for the one at 1160 us (64 * 18 + 8): its vector
/// says 64 * 18 + 60 and has no events.
std::vector<uint8_t> with_empty_vector() {
  EventBatch batch;
  for (int64_t i = 0; i < 400; ++i) batch.events.push_back({30, static_cast<uint16_t>(i % 48), 1, 1000 + i});
  std::vector<uint8_t> bytes = encoded(batch, "evt2.1", {.width = 64, .height = 48});

  const auto head = [](uint32_t low_us) { return 1u << 28 | low_us << 22 | 160 % 48; };
  const auto as_bytes = [](uint64_t word) {
    std::array<uint8_t, 8> result{};
    std::memcpy(result.data(), &word, result.size());
    return result;
  };
  const auto sound = as_bytes(uint64_t{head(8)} << 32 | 1u << 30), empty = as_bytes(uint64_t{head(60)} << 32);
  const auto place = std::search(bytes.begin(), bytes.end(), sound.begin(), sound.end());
  EXPECT_NE(place, bytes.end());
  if (place != bytes.end()) std::copy(empty.begin(), empty.end(), place);
  return bytes;
}

/// Its time, 1212 us, is later than that of the events behind it.
TEST(HostileEvt21, EmptyVectorDoesNotMoveLaterEvents) {
  const auto events = read_bytes(with_empty_vector(), "evt2.1").value().events;
  ASSERT_EQ(events.size(), 399u);
  for (size_t i = 0; i < events.size(); ++i) {
    EXPECT_EQ(events.t[i], 1000 + static_cast<int64_t>(i < 160 ? i : i + 1)) << i;
  }
}

}  // namespace
}  // namespace e2lf::recordings
