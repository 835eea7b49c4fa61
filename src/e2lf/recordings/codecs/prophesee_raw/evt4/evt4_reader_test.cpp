// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/recordings/open/registry.h"
#include "testing/chunked_source.h"
#include "testing/test_evt4.h"
#include "testing/test_streams.h"

namespace e2lf::recordings {
namespace {

TEST(Evt4, EventsVectorsAndTriggersAreRead) {
  const auto bytes = evt4_of_words({evt4_event(0xB, 1, 9, 9),                 // in front of the first time
                                    0xE0000002,                               // 128 us
                                    evt4_event(0xB, 3, 5, 6),                 //
                                    evt4_event(0xC, 4, 30, 7), 0x80000005,    // 30, 32 and 61
                                    0x90000000 | 5U << 22 | 3U << 8 | 1,      // a rising edge at input 3
                                    evt4_event(0x6, 6, 0, 0x14), 0x70000009,  // what the sensor counted
                                    0xFFFFFFFF, 0xE0000003,                   //
                                    evt4_event(0xD, 0, 1, 2), 0x00000001,     //
                                    evt4_event(0xA, 63, 63, 47)});
  OpenOptions options = {.policy = DecodePolicy::kSkip};
  for (const size_t step : {size_t{1}, size_t{7}, size_t{4096}}) {
    auto reader = open_recording(chunked(bytes, step), options).value();
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

TEST(Evt4, StreamsComeBackAsTheyWereWritten) {
  const EventBatch stream =
      random_stream({.events = 3000, .width = 64, .height = 48, .max_gap_us = 300, .trigger_every = 10});
  const auto bytes = evt4_file(stream);
  auto reader = open_bytes(bytes, {}).value();
  const auto all = read_all(*reader);
  ASSERT_TRUE(all) << all.error().text();
  EXPECT_EQ(all->events, stream.events);
  EXPECT_EQ(all->triggers, stream.triggers);
}

TEST(Evt4, WhatIsCutOrUnknownIsCounted) {
  auto bytes = evt4_of_words({0xE0000002, evt4_event(0xB, 3, 5, 6), 0x12345678, evt4_event(0xC, 4, 30, 7)});
  const Decoded read = decoded(bytes);
  EXPECT_EQ(read.batch.events.size(), 1U);
  EXPECT_EQ(read.summary.of(Violation::kUnknownWord).count, 1U);
  EXPECT_EQ(read.summary.of(Violation::kTruncated).count, 1U);
}

}  // namespace
}  // namespace e2lf::recordings
