// SPDX-License-Identifier: MIT
#include <algorithm>
#include <gtest/gtest.h>
#include <lz4frame.h>
#include <numeric>

#include "e2lf/files/file.h"
#include "e2lf/recordings/open/registry.h"
#include "e2lf/recordings/recording.h"
#include "testing/chunked_source.h"
#include "testing/test_rosbag.h"
#include "testing/test_streams.h"

namespace e2lf::formats::rosbag {
namespace {

Decoded read(const Bytes& bytes, const std::string& stream = "") {
  return decoded(bytes, {.stream = stream});
}

template <typename T>
int64_t sum(const Column<T>& column) {
  return std::accumulate(column.begin(), column.end(), int64_t{0});
}

constexpr uint64_t kBaseNs = 1'700'000'000'000'000'000;
constexpr int64_t kBaseUs = 1'700'000'000'000'000;

/// An event of the encoding "mono" dt_us behind the base.
uint64_t mono(uint64_t x, uint64_t y, uint64_t p, uint64_t dt_us) {
  return p << 63 | y << 48 | x << 32 | dt_us * 1000;
}

Bytes lz4(const Bytes& bytes) {
  Bytes packed(LZ4F_compressFrameBound(bytes.size(), nullptr));
  packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), bytes.data(), bytes.size(), nullptr));
  return packed;
}

/// A message of mono events, of two events each.
Bytes mono_message(uint64_t number, uint64_t dt_us, uint64_t x = 1) {
  return packet_message(number, "mono", kBaseNs, words<uint64_t>({mono(x, 2, 1, dt_us), mono(x + 1, 3, 0, dt_us + 1)}));
}

TEST(Rosbag, McapIsReadWithAndWithoutChunks) {
  const TestMessages messages = {{0, mono_message(0, 10)}, {0, mono_message(1, 20)}};
  for (const Bytes& file :
       {mcap_file({{"/cam/events"}}, messages), mcap_file({{"/cam/events"}}, messages, "lz4", lz4)}) {
    const Decoded opened = read(file);
    EXPECT_EQ(opened.info.format, "mcap");
    EXPECT_EQ(opened.info.width, 640U);
    ASSERT_EQ(opened.batch.events.size(), 4U);
    EXPECT_EQ(opened.batch.events[0], (Event{1, 2, 1, kBaseUs + 10}));
    EXPECT_EQ(opened.batch.events[3], (Event{2, 3, 0, kBaseUs + 21}));
    EXPECT_TRUE(losses(opened.summary).empty());
    const OpenOptions options{.policy = DecodePolicy::kSkip};
    const Decoded live = decoded(open_recording(chunked(file, 7), options));
    EXPECT_EQ(live.batch, opened.batch);
  }
}

TEST(Rosbag, TopicsAreStreamsAndTriggersLieBesideThem) {
  const Bytes trigger = packet_message(0, "trigger", kBaseNs, words<uint64_t>({mono(0, 1, 1, 12), mono(0, 1, 0, 13)}));
  const Bytes file = mcap_file({{"/left/events"}, {"/right/events"}, {"/left/trigger"}},
                               {{0, mono_message(0, 10)}, {2, trigger}, {1, mono_message(0, 10, 50)}});
  const Decoded left = read(file);
  EXPECT_EQ(left.batch.events.x, (Column<uint16_t>{1, 2}));
  EXPECT_EQ(left.batch.triggers, (std::vector<Trigger>{{kBaseUs + 12, 1, 1}, {kBaseUs + 13, 1, 0}}));
  EXPECT_EQ(left.summary.other_streams, 1U);
  ASSERT_EQ(left.info.assumptions.size(), 1U);
  const Decoded right = read(file, "/right/events");
  EXPECT_EQ(right.batch.events.x, (Column<uint16_t>{50, 51}));
  EXPECT_TRUE(right.batch.triggers.empty());
  EXPECT_EQ(right.summary.other_streams, 0U);
}

TEST(Rosbag, ListsOfEventsAreRead) {
  const EventBatch events = random_stream({.events = 500, .width = 640, .height = 480, .begin_us = kBaseUs});
  const Decoded opened = read(mcap_file({{"/dvs/events", kListType}}, {{0, list_message(events.events)}}));
  EXPECT_EQ(opened.batch.events, events.events);
  EXPECT_EQ(opened.info.height, 480U);
}

/// The words of a recording, without its header, as messages of so many bytes.
TestMessages evt3_messages(const EventBatch& events, size_t step) {
  const Bytes raw = encoded(events, "evt3");
  const std::string_view end = "% end\n";
  auto next = std::search(raw.begin(), raw.end(), end.begin(), end.end()) + 6;
  TestMessages messages;
  while (next != raw.end()) {
    const auto part = std::min<ptrdiff_t>(static_cast<ptrdiff_t>(step), raw.end() - next);
    messages.emplace_back(0, packet_message(messages.size(), "evt3", 0, Bytes(next, next + part)));
    next += part;
  }
  return messages;
}

TEST(Rosbag, Evt3IsDecodedAcrossMessagesSoughtAndCountedWhereMessagesAreMissing) {
  const EventBatch events = random_stream({.events = 5000, .width = 640, .height = 480, .trigger_every = 100});
  TestMessages messages = evt3_messages(events, 500);
  const Bytes file = mcap_file({{"/events"}}, messages);
  const Decoded opened = read(file);
  EXPECT_EQ(opened.batch, events);
  EXPECT_EQ(opened.info.format, "mcap");
  EXPECT_EQ(opened.info.find("encoding"), "evt3");
  EXPECT_TRUE(losses(opened.summary).empty());

  OpenOptions late = {.from_us = events.events.t[4000]};
  const auto rest = decoded(open_bytes(file, late));
  EXPECT_EQ(rest.batch.events.t.front(), events.events.t[4000]);
  EXPECT_EQ(rest.batch.events.t.back(), events.events.t.back());

  messages.erase(messages.begin() + 5);
  const Decoded lossy = read(mcap_file({{"/events"}}, messages));
  EXPECT_GE(lossy.summary.of(Violation::kMisaligned).count, 1U);
  EXPECT_LT(lossy.batch.events.size(), 5000U);
  EXPECT_GT(lossy.batch.events.size(), 4000U);
}

TEST(Rosbag, DamageIsCountedAndClaimsAreNotBelieved) {
  Bytes cut = mono_message(0, 10);
  store_le<uint32_t>(&cut[cut.size() - 20], 0x7FFFFFFF);  // the length of the events
  const Decoded opened = read(mcap_file({{"/events"}}, {{0, mono_message(0, 5)}, {0, cut}, {0, mono_message(1, 10)}}));
  EXPECT_EQ(opened.batch.events.size(), 4U);
  EXPECT_EQ(opened.summary.of(Violation::kBadRecord).count, 1U);
  Bytes file = mcap_file({{"/events"}}, {{0, mono_message(0, 5)}});
  file.resize(file.size() - 100 - file.size() / 4);
  EXPECT_EQ(read(file).summary.of(Violation::kTruncated).count, 1U);
}

#ifdef E2LF_HAVE_SQLITE
TEST(Rosbag, ADatabaseIsReadFromMemoryFilesAndFolders) {
  const std::vector<TestTopic> topics = {{"/image", "sensor_msgs/msg/Image"}, {"/cam/events"}};
  const Bytes first = sqlite_file(topics, {{0, {1, 2, 3}}, {1, mono_message(0, 10)}});
  const Bytes second = sqlite_file(topics, {{1, mono_message(1, 20)}});
  EXPECT_EQ(read(first).batch.events.size(), 2U);
  EXPECT_EQ(read(first).info.format, "rosbag");
  TestFolder folder;
  // By their numbers, though not by name.
  ASSERT_TRUE(write_file(folder / "bag #1" / "a_2.db3", first).ok());
  ASSERT_TRUE(write_file(folder / "bag #1" / "a_10.db3", second).ok());
  EXPECT_EQ(decoded(open_recording(folder / "bag #1" / "a_2.db3")).batch.events.size(), 2U);
  EXPECT_TRUE(is_recording_folder(folder / "bag #1"));
  const Decoded opened = decoded(open_recording(folder / "bag #1"));
  EXPECT_EQ(opened.batch.events.x, (Column<uint16_t>{1, 2, 1, 2}));
  EXPECT_TRUE(losses(opened.summary).empty());
}

TEST(Rosbag, ADatabaseThatIsNoBagOrHasNoEventsIsRefused) {
  const Bytes none = sqlite_file({{"/image", "sensor_msgs/msg/Image"}}, {});
  const auto reader = open_bytes(none);
  ASSERT_FALSE(reader.ok());
  EXPECT_NE(reader.error().message.find("topic"), std::string::npos);
  Bytes damaged = sqlite_file({{"/events"}}, {{0, mono_message(0, 10)}});
  std::fill(damaged.begin() + 100, damaged.begin() + 4096, uint8_t{0xFF});
  EXPECT_FALSE(open_bytes(damaged).ok());
}

TEST(RosbagData, TheBagsAtHandHoldWhatIsKnownOfThem) {
  const auto evt3 = data_file("events/other/ros2_trig.db3"), mono_bag = data_file("events/other/ros2_mono.db3");
  E2LF_SKIP_WITHOUT(evt3);
  for (const int threads : {1, 0}) {
    const Decoded opened = decoded(open_recording(evt3, {.threads = threads}));
    EXPECT_EQ(opened.info.format, "rosbag");
    EXPECT_EQ(opened.info.width, 1280U);
    ASSERT_EQ(opened.batch.events.size(), 82469U);
    EXPECT_EQ(sum(opened.batch.events.t), 1222326831810);
    EXPECT_EQ(sum(opened.batch.events.x), 42078718);
    EXPECT_EQ(sum(opened.batch.events.y), 31656267);
    EXPECT_EQ(sum(opened.batch.events.p), 41439);
    ASSERT_EQ(opened.batch.triggers.size(), 2U);
    EXPECT_EQ(opened.batch.triggers[0].t + opened.batch.triggers[1].t, 29096982);
    EXPECT_TRUE(losses(opened.summary).empty());
  }
  const Decoded opened = decoded(open_recording(mono_bag));
  ASSERT_EQ(opened.batch.events.size(), 100U);
  EXPECT_EQ(sum(opened.batch.events.t), 4950);
  EXPECT_EQ(sum(opened.batch.events.x), 34450);
  EXPECT_EQ(sum(opened.batch.events.y), 26450);
  EXPECT_EQ(sum(opened.batch.events.p), 50);
}
#endif

}  // namespace
}  // namespace e2lf::formats::rosbag
