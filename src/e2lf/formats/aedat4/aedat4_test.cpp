// SPDX-License-Identifier: MIT
#include <algorithm>
#include <gtest/gtest.h>
#include <random>

#include "e2lf/files/file.h"
#include "e2lf/recordings/recording.h"
#include "testing/test_aedat4.h"
#include "testing/test_streams.h"

namespace e2lf::formats::aedat4 {
namespace {

/// A file of three event packets with triggers between them, and what it holds.
std::pair<Bytes, EventBatch> example(Compression compression) {
  EventBatch all = random_stream({.events = 300, .begin_us = 1'600'000'000'000'000});
  const auto part = [&](size_t begin) {
    EventColumns events;
    events.append(all.events, begin, begin + 100);
    return event_packet(events);
  };
  const int64_t t1 = all.events.t[50], t2 = all.events.t[150];
  all.triggers = {{t1, 0, 1}, {t2, 0, 0}, {t2 + 1, 1, 1}};
  return {make_file({{0, part(0)},
                     {3, trigger_packet({{0, t1 - 5}, {1, t1}, {2, t2}, {4, t2 + 1}, {8, t2 + 2}})},
                     {2, begin_packet("IMUS", 0)},
                     {0, part(100)},
                     {0, part(200)}},
                    compression),
          all};
}

/// A file of 60 event packets, with a packet of triggers in front of every tenth, that reach as far as those ten.
std::pair<Bytes, EventBatch> long_example(Compression compression) {
  EventBatch all = random_stream({.events = 6000, .begin_us = 1'600'000'000'000'000});
  std::vector<std::pair<int32_t, Bytes>> packets;
  for (size_t begin = 0; begin < all.events.size(); begin += 100) {
    if (begin % 1000 == 0) {
      const int64_t t1 = all.events.t[begin], t2 = all.events.t[begin + 900];
      packets.emplace_back(3, trigger_packet({{1, t1}, {2, t2}}));
      all.triggers.insert(all.triggers.end(), {{t1, 0, 1}, {t2, 0, 0}});
    }
    EventColumns events;
    events.append(all.events, begin, begin + 100);
    packets.emplace_back(0, event_packet(events));
  }
  return {make_file(packets, compression), all};
}

EventBatch read_from(const Bytes& bytes, int64_t from_us) {
  return decoded(bytes, {.from_us = from_us}).batch;
}

EventBatch rest_of(const EventBatch& all, int64_t from_us) {
  EventBatch rest;
  const auto begin = std::lower_bound(all.events.t.begin(), all.events.t.end(), from_us) - all.events.t.begin();
  rest.events.append(all.events, static_cast<size_t>(begin), all.events.size());
  std::copy_if(all.triggers.begin(), all.triggers.end(), std::back_inserter(rest.triggers),
               [from_us](const Trigger& trigger) { return trigger.t >= from_us; });
  return rest;
}

Result<EventBatch> read(const Bytes& bytes, DecodeSummary* summary = nullptr) {
  OpenOptions options = {.policy = DecodePolicy::kSkip};
  E2LF_ASSIGN_OR_RETURN(auto reader, open_bytes(bytes, options));
  E2LF_ASSIGN_OR_RETURN(EventBatch batch, read_all(*reader));
  if (summary != nullptr) *summary = reader->summary();
  return batch;
}

/// Replaces the header's XML in place, without changing its length.
void replace_all(Bytes& bytes, const std::string& from, const std::string& to) {
  ASSERT_EQ(from.size(), to.size());
  for (auto at = bytes.begin(); (at = std::search(at, bytes.end(), from.begin(), from.end())) != bytes.end(); at += 1) {
    std::copy(to.begin(), to.end(), at);
  }
}

TEST(Aedat4, FilesOfOtherWritersAreRead) {
  const auto [bytes, expected] = example(Compression::kNone);
  Bytes with_line_feed = bytes;
  with_line_feed.erase(with_line_feed.begin() + 12);  // the carriage return
  Bytes single_quoted = bytes;
  for (const char* key :
       {"key=\"typeIdentifier\"", "key=\"sizeX\"", "key=\"sizeY\"", "path=\"/mainloop/Recorder/outInfo/0/\""}) {
    std::string quoted = key;
    std::replace(quoted.begin(), quoted.end(), '"', '\'');
    replace_all(single_quoted, key, quoted);
  }
  for (const Bytes& file : {with_line_feed, single_quoted}) {
    DecodeSummary summary;
    const auto batch = read(file, &summary);
    ASSERT_TRUE(batch.ok()) << batch.error().text();
    EXPECT_EQ(*batch, expected);
    EXPECT_EQ(summary.num_violations(), 0U);
  }
}

TEST(Aedat4, APacketOfAnUnlistedStreamIsCountedAndPassedOver) {
  const EventBatch all = random_stream({.events = 200});
  const auto part = [&](size_t begin) {
    EventColumns events;
    events.append(all.events, begin, begin + 100);
    return event_packet(events);
  };
  DecodeSummary summary;
  const auto batch = read(make_file({{0, part(0)}, {77, part(0)}, {0, part(100)}}, Compression::kNone), &summary);
  ASSERT_TRUE(batch.ok()) << batch.error().text();
  EXPECT_EQ(batch->events, all.events);
  EXPECT_EQ(summary.other_streams, 1U);
  EXPECT_EQ(summary.num_violations(), 0U);
}

TEST(Aedat4, NanosecondsAreRefused) {
  EventBatch all = random_stream({.events = 100});
  for (int64_t& t : all.events.t) t = 1'600'000'000'000'000'000 + 1000 * t;
  const auto batch = read(make_file({{0, event_packet(all.events)}}, Compression::kNone));
  ASSERT_FALSE(batch.ok());
  EXPECT_EQ(batch.error().code, ErrorCode::kFormat);
}

TEST(Aedat4, EventsAndExternalSignalsAreReadForEveryCompression) {
  std::vector<Compression> compressions = {Compression::kNone, Compression::kLz4};
#ifdef E2LF_HAVE_ZSTD
  compressions.push_back(Compression::kZstd);
#endif
  for (const Compression compression : compressions) {
    const auto [bytes, expected] = example(compression);
    DecodeSummary summary;
    auto batch = read(bytes, &summary);
    ASSERT_TRUE(batch.ok()) << batch.error().text();
    EXPECT_EQ(batch->events, expected.events);
    EXPECT_EQ(batch->triggers, expected.triggers);
    EXPECT_EQ(summary.num_violations(), 0u);
  }
}

/// Two events and a trigger of each of two cameras.
Bytes two_cameras() {
  EventColumns first, second;
  for (const int64_t t_us : {100, 200}) {
    first.push_back({1, 2, 1, t_us});
    second.push_back({600, 400, 0, t_us + 5});
  }
  return make_file({{0, event_packet(first)},
                    {4, event_packet(second)},
                    {3, trigger_packet({{1, 150}})},
                    {5, trigger_packet({{2, 160}})}},
                   Compression::kNone, kTwoCameras);
}

TEST(Aedat4, TheSecondCameraIsCountedAsLeftOut) {
  const Bytes bytes = two_cameras();
  const Decoded read = decoded(bytes);
  EXPECT_EQ(read.batch.events.x, (Column<uint16_t>{1, 1}));
  EXPECT_EQ(read.batch.triggers, (std::vector<Trigger>{{150, 0, 1}}));
  EXPECT_EQ(read.summary.other_streams, 2U);
  const auto left_out = losses(read.summary);
  ASSERT_EQ(left_out.size(), 1U);
  EXPECT_EQ(left_out[0].reason, "other_stream");
  ASSERT_EQ(read.info.assumptions.size(), 1U);
  EXPECT_NE(read.info.assumptions[0].text.find("4 (events of DVXplorer_2)"), std::string::npos);
}

TEST(Aedat4, AStreamIsChosenByNumberOrCamera) {
  const Bytes bytes = two_cameras();
  for (const char* stream : {"4", "DVXplorer_2"}) {
    const Decoded read = decoded(open_bytes(bytes, {.policy = DecodePolicy::kStrict, .stream = stream}));
    EXPECT_EQ(read.info.width, 640U);
    EXPECT_EQ(read.batch.events.x, (Column<uint16_t>{600, 600}));
    EXPECT_EQ(read.batch.triggers, (std::vector<Trigger>{{160, 0, 0}}));
    EXPECT_TRUE(losses(read.summary).empty());
  }
}

TEST(Aedat4, AStreamThatIsNotThereOrNotOneIsRefused) {
  const Bytes bytes = two_cameras();
  for (const char* stream : {"7", "events", "left"}) {
    const auto reader = open_bytes(bytes, {.stream = stream});
    ASSERT_FALSE(reader.ok()) << stream;
    EXPECT_EQ(reader.error().code, ErrorCode::kInvalidValue);
    EXPECT_NE(reader.error().message.find("0 (events of DAVIS346_1)"), std::string::npos);
  }
  auto strict = open_bytes(bytes, {.policy = DecodePolicy::kStrict}).value();
  EXPECT_FALSE(read_all(*strict).ok());
}

TEST(Streams, AFormatOfOneStreamRefusesTheChoice) {
  const std::string text = "1,2,1,5\n";
  const auto reader = open_recording(make_memory_source({text.begin(), text.end()}), {.stream = "1"});
  ASSERT_FALSE(reader.ok());
  EXPECT_EQ(reader.error().code, ErrorCode::kInvalidValue);
}

TEST(Aedat4, UnknownCompressionIsRefused) {
  auto batch = read(make_file({}, static_cast<Compression>(9)));
  ASSERT_FALSE(batch.ok());
  EXPECT_EQ(batch.error().code, ErrorCode::kUnsupported);
}

TEST(Aedat4, EveryTruncationGivesTheEventsBeforeIt) {
  const auto [bytes, expected] = example(Compression::kNone);
  size_t opened = 0;
  for (size_t length = 0; length < bytes.size(); ++length) {
    auto batch = read({bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(length)});
    if (!batch.ok()) continue;
    ++opened;
    const size_t count = batch->events.size();
    EXPECT_EQ(count % 100, 0u) << length;
    EXPECT_TRUE(std::equal(batch->events.t.begin(), batch->events.t.end(), expected.events.t.begin()));
  }
  EXPECT_GT(opened, 4000u);
}

TEST(Aedat4, FlippedBitsNeverTurnTimeBack) {
  std::mt19937 random(5);
  for (const Compression compression : {Compression::kNone, Compression::kLz4}) {
    const Bytes good = example(compression).first;
    for (int trial = 0; trial < 2000; ++trial) {
      Bytes bytes = good;
      bytes[random() % bytes.size()] ^= static_cast<uint8_t>(1u << random() % 8);
      auto batch = read(bytes);
      if (!batch.ok()) continue;
      EXPECT_LE(batch->events.size(), 300u);
      EXPECT_TRUE(std::is_sorted(batch->events.t.begin(), batch->events.t.end()));
    }
  }
}

TEST(Aedat4, TriggersInFrontOfDamageAreInOrderToo) {
  const EventBatch events = random_stream({.events = 100});
  const int64_t t1 = events.events.t[50], t2 = events.events.t[60];
  Bytes triggers = trigger_packet({{1, t2}, {2, t1}, {1, t2 + 1}});
  constexpr size_t kTableBytes = 24;
  store_le(&triggers[triggers.size() - 3 * kTableBytes - 4], 0x7FFFFFFFU);  // where the third one is
  DecodeSummary summary;
  const auto batch = read(make_file({{3, triggers}, {0, event_packet(events.events)}}, Compression::kNone), &summary);
  ASSERT_TRUE(batch.ok()) << batch.error().text();
  EXPECT_EQ(batch->triggers, (std::vector<Trigger>{{t2, 0, 1}, {t2, 0, 0}}));
  EXPECT_EQ(summary.num_violations(), 1U);
}

TEST(Aedat4, PacketThatClaimsTooMuchIsNotAllocated) {
  Bytes bytes = example(Compression::kNone).first;
  put<int32_t>(bytes, 0);
  put<int32_t>(bytes, INT32_MAX);
  DecodeSummary summary;
  auto batch = read(bytes, &summary);
  ASSERT_TRUE(batch.ok());
  EXPECT_EQ(batch->events.size(), 300u);
  EXPECT_EQ(summary.of(Violation::kMisaligned).count, 1u);
}

TEST(Aedat4, SeekingGivesTheRest) {
  for (const Compression compression : {Compression::kNone, Compression::kLz4}) {
    const auto [bytes, all] = long_example(compression);
    for (size_t event = 0; event < all.events.size(); event += 37) {
      for (const int64_t from_us : {all.events.t[event], all.events.t[event] + 1}) {
        EXPECT_EQ(read_from(bytes, from_us), rest_of(all, from_us)) << event;
      }
    }
    EXPECT_TRUE(read_from(bytes, all.events.t.back() + 1).empty());
  }
}

TEST(Aedat4, SeekingInADamagedFileGivesTheRestAsAScanDoes) {
  std::mt19937 random(7);
  // Not compressed: what is damaged in a compressed packet spoils all its times, which a scan gets over later than a
  // seek.
  const auto [good, all] = long_example(Compression::kNone);
  for (int trial = 0; trial < 300; ++trial) {
    Bytes bytes = good;
    for (int i = 0; i < 3; ++i)
      bytes[2000 + random() % (bytes.size() - 2000)] ^= static_cast<uint8_t>(1u << random() % 8);
    if (trial % 3 == 0) bytes.resize(bytes.size() / 2 + random() % (bytes.size() / 2));
    const EventBatch scanned = read_from(bytes, INT64_MIN);
    const int64_t from_us = all.events.t[random() % all.events.size()];
    EXPECT_EQ(read_from(bytes, from_us), rest_of(scanned, from_us)) << trial;
  }
}

TEST(Aedat4, DamagedRealFilesAreSurvived) {
  const auto path = data_file("events/other/davis.aedat4");
  E2LF_SKIP_WITHOUT(path);
  auto good = read_file(path);
  ASSERT_TRUE(good.ok());
  std::mt19937 random(9);
  for (int trial = 0; trial < 60; ++trial) {
    Bytes bytes = *good;
    for (int i = 0; i < 20; ++i) bytes[4000 + random() % (bytes.size() - 4000)] ^= static_cast<uint8_t>(random());
    if (trial % 2 == 0) bytes.resize(random() % bytes.size());
    auto batch = read(bytes);
    if (!batch.ok()) continue;
    EXPECT_LE(batch->events.size(), 117667u);
    EXPECT_TRUE(std::is_sorted(batch->events.t.begin(), batch->events.t.end()));
  }
}

}  // namespace
}  // namespace e2lf::formats::aedat4
