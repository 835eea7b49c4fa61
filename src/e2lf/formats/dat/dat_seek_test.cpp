// SPDX-License-Identifier: MIT
#include <algorithm>
#include <gtest/gtest.h>

#include "e2lf/base/little_endian.h"
#include "e2lf/recordings/recording.h"
#include "testing/test_streams.h"

namespace e2lf::formats::dat {
namespace {

constexpr size_t kRecordBytes = 8;

/// Events of 2.2 hours: the clock wraps twice.
EventBatch long_stream() {
  return random_stream(
      {.events = 2'000'000, .width = 64, .height = 48, .begin_us = 4'000'000'000, .max_gap_us = 8'000});
}

std::vector<uint8_t> written(const EventBatch& batch) {
  return encoded(batch, "dat", {.width = 64, .height = 48});
}

/// The records of a file, which are at its end.
size_t header_bytes(const std::vector<uint8_t>& bytes, const EventBatch& batch) {
  return bytes.size() - batch.events.size() * kRecordBytes;
}

EventColumns read_from(const std::vector<uint8_t>& bytes, int64_t from_us) {
  return decoded(bytes, {.format = "dat", .from_us = from_us}).batch.events;
}

EventColumns rest_of(const EventColumns& events, int64_t from_us) {
  EventColumns rest;
  const auto begin = std::lower_bound(events.t.begin(), events.t.end(), from_us) - events.t.begin();
  rest.append(events, static_cast<size_t>(begin), events.size());
  return rest;
}

TEST(DatHeader, LinesOfOtherFormsDoNotEndIt) {
  const std::vector<uint8_t> plain = encoded(random_stream({.events = 10}), "dat");
  for (const std::string line : {"%", "%comment", "% (text)", "%% x", "%\tx y", "% Gr\u00f6\u00dfe 5"}) {
    std::vector<uint8_t> bytes = plain;
    const std::string text = line + "\n";
    const auto first_end = std::find(bytes.begin(), bytes.end(), uint8_t{'\n'}) + 1;
    bytes.insert(first_end, text.begin(), text.end());
    const Decoded read = decoded(bytes);
    EXPECT_EQ(read.info.width, 640U) << line;
    EXPECT_EQ(read.batch.events.size(), 10U) << line;
  }
}

TEST(TimeUnwrapper, OneDamagedRecordDoesNotMoveTheClock) {
  constexpr uint32_t kTimes[] = {0, 1, 1u << 30, 1u << 31, 0xC0000000, 0xF0000000, 0xFFFFFFFF};
  for (const uint32_t now : kTimes) {
    for (const uint32_t damaged : kTimes) {
      TimeUnwrapper<32> clock(5 * (int64_t{1} << 32) + now);
      const int64_t before = clock(now);
      static_cast<void>(clock(damaged));
      EXPECT_EQ(clock(now + 10), before + 10) << now << " " << damaged;
    }
  }
}

TEST(TimeUnwrapper, FollowsAPause) {
  TimeUnwrapper<32> clock;
  const int64_t half = int64_t{1} << 31, wrap_us = int64_t{1} << 32;
  EXPECT_EQ(clock(5), 5);
  for (int64_t i = 0; i < 100; ++i) EXPECT_EQ(clock(static_cast<uint32_t>(half + i)), half + i);
  for (int64_t t_us = half; t_us < 2 * wrap_us; t_us += wrap_us / 16) {
    EXPECT_EQ(clock(static_cast<uint32_t>(t_us)), t_us);
  }
  EXPECT_EQ(clock(0xFFFFFFFF), 2 * wrap_us - 1);
}

TEST(DatSeek, GivesTheRestAcrossWrapsOfTheClock) {
  const EventBatch batch = long_stream();
  const auto bytes = written(batch);
  const EventColumns& events = batch.events;
  ASSERT_GT(events.t.back() - events.t.front(), int64_t{1} << 32);
  for (const int64_t from_us : {int64_t{0}, events.t.front(), events.t[1], events.t[70'000] + 1, int64_t{1} << 32,
                                (int64_t{1} << 33) - 1, events.t[1'400'000], events.t.back(), events.t.back() + 1}) {
    EXPECT_EQ(read_from(bytes, from_us), rest_of(events, from_us)) << from_us;
  }
}

TEST(DatSeek, GivesTheRestOfADamagedFileAsAScanDoes) {
  const EventBatch batch = long_stream();
  auto bytes = written(batch);
  const size_t begin = header_bytes(bytes, batch);
  std::mt19937 random(3);
  for (int i = 0; i < 6000; ++i) bytes[begin + random() % (bytes.size() - begin)] = static_cast<uint8_t>(random());
  std::fill_n(bytes.begin() + static_cast<ptrdiff_t>(begin + 8 * 300'000), 8 * 1000, uint8_t{0});
  bytes.resize(bytes.size() - 3);
  const EventColumns scanned = read_from(bytes, INT64_MIN);
  ASSERT_GT(scanned.size(), 1'990'000u);
  EXPECT_LE(scanned.t.back(), batch.events.t.back());
  for (size_t event = 0; event < batch.events.size(); event += 300'007) {
    const int64_t from_us = batch.events.t[event];
    EXPECT_EQ(read_from(bytes, from_us), rest_of(scanned, from_us)) << event;
  }
}

}  // namespace
}  // namespace e2lf::formats::dat
