// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <random>

#include "e2lf/recordings/recording.h"
#include "testing/chunked_source.h"
#include "testing/test_aedat.h"
#include "testing/test_streams.h"

namespace e2lf::recordings::aedat {
namespace {

TEST(Aedat2, Dvs128IsReadFromTheTopLeft) {
  // Column 5 from the right, row 7 from the bottom; bit 0 is set for OFF.
  const Bytes bytes = aedat2_file("# AEChip: ch.unizh.ini.jaer.chip.retina.DVS128\r\n",
                                  {{7 << 8 | 5 << 1, 100}, {7 << 8 | 5 << 1 | 1, 101}, {0x8000, 150}, {0, 0x7FFFFFFF}});
  const Decoded opened = decoded(bytes);
  EXPECT_EQ(opened.info.format, "aedat2");
  EXPECT_EQ(opened.info.width, 128U);
  ASSERT_EQ(opened.batch.events.size(), 3U);
  EXPECT_EQ(opened.batch.events[0], (Event{122, 120, 1, 100}));
  EXPECT_EQ(opened.batch.events[1], (Event{122, 120, 0, 101}));
  EXPECT_EQ(opened.batch.triggers, (std::vector<Trigger>{{150, 0, 1}}));
  EXPECT_EQ(opened.summary.num_violations(), 0U);
}

TEST(Aedat2, Davis240IsReadWithoutItsFramesAndWithItsTriggers) {
  const uint32_t on = 9U << 22 | 4U << 12 | 1U << 11, off = 9U << 22 | 4U << 12, falling = 1U << 10 | 2U,
                 rising = 1U << 10 | 3U, frame = 1U << 31 | 9U << 22, outside = 200U << 22;
  const Bytes bytes = aedat2_file("# AEChip: eu.seebetter.ini.chips.davis.DAVIS240C\r\n",
                                  {{on, 10}, {frame, 3}, {off, 11}, {rising, 12}, {falling, 13}, {outside, 14}});
  const Decoded opened = decoded(bytes);
  EXPECT_EQ(opened.info.height, 180U);
  ASSERT_EQ(opened.batch.events.size(), 2U);
  EXPECT_EQ(opened.batch.events[0], (Event{235, 170, 1, 10}));
  EXPECT_EQ(opened.batch.events[1], (Event{235, 170, 0, 11}));
  EXPECT_EQ(opened.batch.triggers, (std::vector<Trigger>{{12, 0, 1}, {13, 0, 0}}));
  EXPECT_EQ(opened.summary.of(Violation::kOutOfRange).count, 1U);
}

TEST(Aedat2, ACameraThatIsNotNamedIsFoundByAllAddresses) {
  const Decoded dvs = decoded(aedat2_file("", {{7 << 8 | 5 << 1, 100}}));
  EXPECT_EQ(dvs.info.width, 128U);
  EXPECT_EQ(dvs.info.assumptions.size(), 1U);
  // The last of many addresses exceeds a DAVIS240.
  std::vector<std::pair<uint32_t, uint32_t>> records(5000, {9U << 22 | 30U << 12, 100});
  records.emplace_back(9U << 22 | 300U << 12, 100);
  const Bytes bytes = aedat2_file("", records);
  const Decoded davis = decoded(bytes);
  EXPECT_EQ(davis.info.width, 346U);
  EXPECT_EQ(davis.batch.events[0], (Event{315, 250, 0, 100}));
  EXPECT_EQ(davis.batch.events[5000], (Event{45, 250, 0, 100}));
  // A pipe cannot be read twice.
  const auto piped = open_recording(chunked(bytes, 1000));
  ASSERT_FALSE(piped.ok());
  EXPECT_EQ(piped.error().setting, Setting::kSensorSize);
  const Decoded sized = decoded(chunked(bytes, 1000), {.width = 346, .height = 260});
  EXPECT_EQ(sized.batch.events, davis.batch.events);
  EXPECT_TRUE(sized.info.assumptions.empty());
}

TEST(Aedat2, SeveralCamerasAreStreams) {
  std::vector<std::pair<uint32_t, uint32_t>> records;
  for (uint32_t i = 0; i < 40; ++i) records.emplace_back(9U << 22 | (i % 4) << 12 | 1U << 11 | i % 4, i);
  const Bytes bytes = aedat2_file("# AEChip: eu.seebetter.ini.chips.davis.DAVIS346\r\n", records);
  const Decoded first = decoded(bytes);
  EXPECT_EQ(first.info.streams.size(), 4U);
  EXPECT_EQ(first.info.assumptions.size(), 1U);
  EXPECT_EQ(first.batch.events.size(), 10U);
  EXPECT_EQ(first.summary.other_streams, 30U);
  const Decoded third = decoded(bytes, {.stream = "2"});
  ASSERT_EQ(third.batch.events.size(), 10U);
  EXPECT_EQ(third.batch.events[0], (Event{343, 250, 1, 2}));
  EXPECT_EQ(third.summary.other_streams, 0U);
}

TEST(Aedat2, ARecordThatBeginsWithAHashIsNoLineOfTheHeader) {
  const uint32_t address = 0x23000000;  // '#'
  const Decoded opened = decoded(aedat2_file("# AEChip: DAVIS240C\r\n", {{address, 1}, {address, 0x0A0A}}));
  EXPECT_EQ(opened.batch.events.size(), 2U);
}

TEST(AedatOfTwoParts, GoOnBehindTheHeaderOfTheLaterOneEvenWhereItIsDamaged) {
  const Bytes second = aedat2_file("# AEChip: DVS128\r\n", {{0, 1}, {0, 1}});
  const Bytes third = aedat3_file("#Source 1: DVS128\r\n", {polarity_packet(1, 0, {{3, 4, 1, 100}})});
  for (const Bytes& one : {second, third}) {
    Bytes twice = one;
    twice.insert(twice.end(), one.begin(), one.end());
    const Decoded whole = decoded(twice);
    EXPECT_EQ(whole.batch.events.size(), one == second ? 4U : 2U);
    EXPECT_EQ(whole.summary.num_violations(), 0U);
    twice[one.size() + 12] = 1;  // no text: the line is no header
    EXPECT_GT(decoded(twice).summary.num_violations(), 0U);
  }
}

TEST(Aedat2, ACutRecordIsCounted) {
  Bytes bytes = aedat2_file("# AEChip: DVS128\r\n", {{0, 1}, {0, 2}});
  bytes.pop_back();
  const Decoded opened = decoded(bytes);
  EXPECT_EQ(opened.batch.events.size(), 1U);
  EXPECT_EQ(opened.summary.of(Violation::kTruncated).count, 1U);
}

TEST(Aedat2, TriggersBesideARestartBelongToThePartOfTheirPlaceInAFileAndAPipe) {
  constexpr uint32_t kTrigger = 0x8000;
  std::vector<std::pair<uint32_t, uint32_t>> records;
  std::vector<Trigger> expected;
  for (const auto& [first_us, shift_us] : {std::pair<uint32_t, int64_t>{40'000, 0}, {50, 59'851}}) {
    for (uint32_t i = 0; i < 200; ++i) {
      const uint32_t t_us = first_us + 100 * i;
      records.emplace_back(i % 3 == 0 ? kTrigger : 7 << 8 | 5 << 1, t_us);
      if (i % 3 == 0) expected.push_back({t_us + shift_us, 0, 1});
    }
  }
  const Bytes bytes = aedat2_file("# AEChip: DVS128\r\n", records);
  const Decoded file = decoded(bytes);
  EXPECT_EQ(file.batch.triggers, expected);
  EXPECT_EQ(file.summary.num_violations(), 0U);
  for (const size_t step : {8U, 100U, 1000U}) {
    EXPECT_EQ(decoded(chunked(bytes, step)).batch, file.batch) << step;
  }
}

TEST(Aedat3, PolarityAndSpecialEventsAreRead) {
  const Bytes bytes = aedat3_file("#Source 1: DVS128\r\n", {polarity_packet(1, 1, {{3, 4, 1, 100}, {5, 6, 0, 101}}),
                                                            special_packet(1, 1, {{2, 50}, {3, 60}, {6, 61}})});
  const Decoded opened = decoded(bytes);
  const int64_t loop_us = int64_t{1} << 31;
  EXPECT_EQ(opened.info.format, "aedat3");
  EXPECT_EQ(opened.info.width, 128U);
  ASSERT_EQ(opened.batch.events.size(), 2U);
  EXPECT_EQ(opened.batch.events[0], (Event{3, 4, 1, loop_us + 100}));
  EXPECT_EQ(opened.batch.events[1], (Event{5, 6, 0, loop_us + 101}));
  EXPECT_EQ(opened.batch.triggers,
            (std::vector<Trigger>{{loop_us + 50, 0, 1}, {loop_us + 60, 0, 0}, {loop_us + 61, 1, 1}}));
  EXPECT_EQ(opened.summary.num_violations(), 0U);
}

TEST(Aedat3, SeveralSourcesAreStreams) {
  const Bytes bytes = aedat3_file("#Source 1: DVS128\r\n#Source 2: DAVIS240C\r\n",
                                  {polarity_packet(1, 0, {{3, 4, 1, 100}}), polarity_packet(2, 0, {{200, 6, 0, 101}})});
  EXPECT_EQ(decoded(bytes).summary.other_streams, 1U);
  OpenOptions second = {.stream = "DAVIS240C"};
  const Decoded opened = decoded(bytes, second);
  EXPECT_EQ(opened.info.width, 240U);
  ASSERT_EQ(opened.batch.events.size(), 1U);
  EXPECT_EQ(opened.batch.events[0], (Event{200, 6, 0, 101}));
  EXPECT_EQ(opened.summary.other_streams, 0U);
}

TEST(Aedat3, APacketThatClaimsTooMuchIsNotAllocated) {
  Bytes packet = polarity_packet(1, 0, {{3, 4, 1, 100}});
  store_le<uint32_t>(&packet[20], INT32_MAX);
  const Decoded opened =
      decoded(aedat3_file("#Source 1: DVS128\r\n", {polarity_packet(1, 0, {{3, 4, 1, 99}}), packet}));
  EXPECT_EQ(opened.batch.events.size(), 1U);
  EXPECT_EQ(opened.summary.of(Violation::kMisaligned).count, 1U);
}

}  // namespace
}  // namespace e2lf::recordings::aedat
