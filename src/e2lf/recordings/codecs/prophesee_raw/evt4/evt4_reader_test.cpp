// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/recordings/open/registry.h"
#include "testing/chunked_source.h"
#include "testing/test_streams.h"

namespace e2lf::recordings {
namespace {

std::vector<uint8_t> recording_of(const std::vector<uint32_t>& words) {
  const std::string header = "% evt 4.0\n% format EVT4;height=48;width=64\n% end\n";
  std::vector<uint8_t> bytes(header.begin(), header.end());
  for (const uint32_t word : words) {
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<uint8_t>(word >> shift));
  }
  return bytes;
}

uint32_t event_word(uint32_t type, uint32_t low_us, uint32_t x, uint32_t y) {
  return type << 28 | low_us << 22 | x << 11 | y;
}

TEST(Evt4, EventsVectorsAndTriggersAreRead) {
  const auto bytes = recording_of({event_word(0xB, 1, 9, 9),                 // in front of the first time
                                   0xE0000002,                               // 128 us
                                   event_word(0xB, 3, 5, 6),                 //
                                   event_word(0xC, 4, 30, 7), 0x80000005,    // 30, 32 and 61
                                   0x90000000 | 5U << 22 | 3U << 8 | 1,      // a rising edge at input 3
                                   event_word(0x6, 6, 0, 0x14), 0x70000009,  // what the sensor counted
                                   0xFFFFFFFF, 0xE0000003,                   //
                                   event_word(0xD, 0, 1, 2), 0x00000001,     //
                                   event_word(0xA, 63, 63, 47)});
  OpenOptions options;
  options.policy = DecodePolicy::kSkip;
  for (const size_t step : {size_t{1}, size_t{7}, size_t{4096}}) {
    auto reader = open_recording(std::make_unique<ChunkedSource>(bytes, std::vector<size_t>(), step), options).value();
    EXPECT_EQ(reader->info().format, "evt4");
    const auto all = read_all(*reader);
    ASSERT_TRUE(all) << all.error().text();
    const std::vector<Event> expected = {{5, 6, 1, 131},  {30, 7, 0, 132}, {32, 7, 0, 132},
                                         {61, 7, 0, 132}, {1, 2, 1, 192},  {63, 47, 0, 255}};
    ASSERT_EQ(all->events.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(all->events[i], expected[i]) << i;
    ASSERT_EQ(all->triggers.size(), 1U);
    EXPECT_EQ(all->triggers[0], (Trigger{133, 3, 1}));
    EXPECT_EQ(reader->summary().events_before_time, 1U);
  }
}

TEST(Evt4, WhatIsCutOrUnknownIsCounted) {
  auto bytes = recording_of({0xE0000002, event_word(0xB, 3, 5, 6), 0x12345678, event_word(0xC, 4, 30, 7)});
  OpenOptions options;
  options.policy = DecodePolicy::kSkip;
  auto reader = open_recording(make_memory_source(std::span<const uint8_t>(bytes)), options).value();
  EXPECT_EQ(read_all(*reader).value().events.size(), 1U);
  EXPECT_EQ(reader->summary().of(Violation::kUnknownWord).count, 1U);
  EXPECT_EQ(reader->summary().of(Violation::kTruncated).count, 1U);
}

}  // namespace
}  // namespace e2lf::recordings
