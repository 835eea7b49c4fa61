// SPDX-License-Identifier: MIT
// Recordings whose clock starts again, because the camera was restarted or files were joined.
#include <fstream>
#include <gtest/gtest.h>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_header.h"
#include "e2lf/recordings/recording.h"
#include "testing/chunked_source.h"
#include "testing/test_aedat4.h"
#include "testing/test_streams.h"

namespace e2lf::recordings {
namespace {

using Bytes = std::vector<uint8_t>;

/// One recording: so many events up to about `end_us`, with triggers.
EventBatch part_of(size_t events, int64_t begin_us, int64_t end_us, uint32_t seed) {
  const auto gap_us = static_cast<uint32_t>(2 * (end_us - begin_us) / static_cast<int64_t>(events));
  return random_stream(
      {.events = events, .begin_us = begin_us, .max_gap_us = gap_us, .trigger_every = 500, .seed = seed});
}

size_t header_bytes(const Bytes& bytes, const std::string& format) {
  if (format == "dat")
    return static_cast<size_t>(std::search(bytes.begin(), bytes.end(), "% end", "% end" + 5) - bytes.begin()) + 8;
  return parse_raw_header(bytes, true, "").value().num_bytes;
}

/// Two recordings in one file.
Bytes joined(const EventBatch& first, const EventBatch& second, const std::string& format, bool with_header) {
  Bytes bytes = encoded(first, format);
  const Bytes later = encoded(second, format);
  const size_t skipped = with_header ? 0 : header_bytes(later, format);
  bytes.insert(bytes.end(), later.begin() + static_cast<ptrdiff_t>(skipped), later.end());
  return bytes;
}

Decoded decode(SourcePtr source, int threads, size_t max_events = RecordingReader::kDefaultBatch) {
  auto reader = open_recording(std::move(source), {.policy = DecodePolicy::kSkip, .threads = threads}).value();
  EventBatch all, batch;
  while (reader->read(batch, max_events).value()) all.append(batch);
  return {std::move(all), reader->summary()};
}

Decoded decode(const Bytes& bytes, int threads, size_t max_events = RecordingReader::kDefaultBatch) {
  return decode(make_memory_source(std::span<const uint8_t>(bytes)), threads, max_events);
}

int64_t last_time(const EventBatch& batch) {
  const int64_t event_us = batch.events.t.back();
  return batch.triggers.empty() ? event_us : std::max(event_us, batch.triggers.back().t);
}

int64_t first_time(const EventBatch& batch) {
  const int64_t event_us = batch.events.t.front();
  return batch.triggers.empty() ? event_us : std::min(event_us, batch.triggers.front().t);
}

/// The second behind the first.
EventBatch continued(EventBatch first, const EventBatch& second, int64_t& shift_us, bool has_triggers = true) {
  if (!has_triggers) first.triggers.clear();
  EventBatch later = second;
  if (!has_triggers) later.triggers.clear();
  shift_us = last_time(first) + 1 - first_time(later);
  for (int64_t& t : later.events.t) t += shift_us;
  for (Trigger& trigger : later.triggers) trigger.t += shift_us;
  first.append(later);
  return first;
}

struct Case {
  const char* format;
  bool with_header;
  int64_t first_end_us, second_begin_us;
};

class ClockThatStartsAgain : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    const Case& test = GetParam();
    first_ = part_of(60'000, 1000, test.first_end_us, 1);
    second_ = part_of(60'000, test.second_begin_us, test.second_begin_us + 6'000'000, 2);
    bytes_ = joined(first_, second_, test.format, test.with_header);
    has_triggers_ = std::string(test.format) != "dat";
  }
  EventBatch first_, second_;
  Bytes bytes_;
  bool has_triggers_ = true;
};

TEST_P(ClockThatStartsAgain, GoesOnBehindTheEarlierPart) {
  int64_t shift_us = 0;
  const EventBatch expected = continued(first_, second_, shift_us, has_triggers_);
  const Decoded one = decode(bytes_, 1);
  EXPECT_TRUE(one.batch == expected);
  ASSERT_EQ(one.summary.num_restarts, 1U);
  EXPECT_EQ(one.summary.restarts[0].shift_us, shift_us);
  EXPECT_EQ(one.summary.num_violations(), 0U);
  EXPECT_EQ(one.summary.events_unplaced, 0U);
  EXPECT_EQ(one.summary.last_t_us, expected.events.t.back());
  for (const int threads : {2, 3, 8}) {
    EXPECT_TRUE(decode(bytes_, threads) == one) << threads;
    EXPECT_TRUE(decode(bytes_, threads, 64) == one) << threads;
  }
  for (const size_t step : {size_t{501}, size_t{70'001}}) {
    const Decoded pieces = decode(chunked(bytes_, step), 1);
    EXPECT_TRUE(pieces.batch == expected) << step;
    EXPECT_EQ(pieces.summary.restarts, one.summary.restarts) << step;
  }
}

TEST_P(ClockThatStartsAgain, CanBeSought) {
  int64_t shift_us = 0;
  const EventBatch expected = continued(first_, second_, shift_us, has_triggers_);
  auto reader = open_bytes(bytes_, {.policy = DecodePolicy::kSkip}).value();
  EventBatch batch;
  for (const size_t i : {size_t{90'000}, size_t{30'000}, size_t{119'000}}) {
    const int64_t t_us = expected.events.t[i];
    const auto first = static_cast<size_t>(std::lower_bound(expected.events.t.begin(), expected.events.t.end(), t_us) -
                                           expected.events.t.begin());
    ASSERT_TRUE(reader->seek(t_us));
    ASSERT_TRUE(reader->read(batch).value());
    EXPECT_EQ(batch.events[0], expected.events[first]);
  }
}

TEST_P(ClockThatStartsAgain, CanBeKeptApart) {
  OpenOptions options = {.policy = DecodePolicy::kSkip, .restart = RestartPolicy::kSplit};
  auto reader = open_bytes(bytes_, options).value();
  for (EventBatch* part : {&first_, &second_}) {
    if (!has_triggers_) part->triggers.clear();
    EXPECT_TRUE(read_all(*reader).value() == *part);
    EXPECT_EQ(reader->summary().events(), part->events.size());
    EXPECT_EQ(reader->next_part().value(), part == &first_);
  }
}

TEST_P(ClockThatStartsAgain, CanBeRefused) {
  OpenOptions options = {.restart = RestartPolicy::kRefuse};
  auto reader = open_bytes(bytes_, options).value();
  const auto all = read_all(*reader);
  ASSERT_FALSE(all);
  EXPECT_NE(all.error().text().find("clock"), std::string::npos) << all.error().text();
  EXPECT_NE(all.error().location.find("byte"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Recordings, ClockThatStartsAgain,
                         testing::Values(Case{"evt2", false, 6'000'000, 500}, Case{"evt2.1", false, 6'000'000, 500},
                                         Case{"evt3", false, 6'000'000, 500}, Case{"evt3", false, 12'000'000, 500},
                                         Case{"evt3", false, 40'000'000, 2'000'000}, Case{"evt2", true, 6'000'000, 500},
                                         Case{"evt2.1", true, 6'000'000, 500}, Case{"evt3", true, 6'000'000, 500},
                                         Case{"evt3", true, 30'000'000, 25'000'000}),
                         [](const auto& test) { return "n" + std::to_string(test.index); });

TEST(JoinedRecordings, OfOneClockKeepTheirTimes) {
  const EventBatch first = part_of(20'000, 1000, 3'000'000, 1);
  const EventBatch second = part_of(20'000, 5'000'000, 9'000'000, 2);
  for (const char* format : {"evt2", "evt2.1", "evt3"}) {
    const Decoded both = decode(joined(first, second, format, true), 1);
    EXPECT_EQ(both.summary.num_restarts, 0U) << format;
    EXPECT_EQ(both.batch.events.t.back(), second.events.t.back()) << format;
    EXPECT_EQ(both.batch.events.size(), 40'000U) << format;
  }
}

TEST(JoinedRecordings, AreFoundBehindACutWord) {
  const EventBatch first = part_of(20'000, 1000, 3'000'000, 1), second = part_of(20'000, 1000, 3'000'000, 2);
  for (const char* format : {"evt2", "evt2.1", "evt3"}) {
    for (size_t cut = 1; cut < 8; ++cut) {
      Bytes bytes = encoded(first, format);
      bytes.resize(bytes.size() - cut);
      const Bytes later = encoded(second, format);
      bytes.insert(bytes.end(), later.begin(), later.end());
      const Decoded both = decode(bytes, 1);
      EXPECT_EQ(both.summary.num_restarts, 1U) << format << cut;
      EXPECT_GE(both.batch.events.size(), 39'960U) << format << cut;
      EXPECT_EQ(both.batch.events.x.back(), second.events.x.back()) << format << cut;
    }
  }
}

TEST(JoinedRecordings, OfAnotherEncodingOrSizeAreRefusedWithTheirPlace) {
  const EventBatch part = part_of(20'000, 1000, 3'000'000, 1);
  Bytes bytes = encoded(part, "evt3");
  const size_t place = bytes.size();
  const Bytes later = encoded(part, "evt2");
  bytes.insert(bytes.end(), later.begin(), later.end());
  auto reader = open_bytes(bytes).value();
  const auto all = read_all(*reader);
  ASSERT_FALSE(all);
  EXPECT_EQ(all.error().location, "memory: byte " + std::to_string(place));
}

/// AEDAT4 packets of 1,000 events, each with its triggers behind it.
Bytes aedat4_of(const EventBatch& first, const EventBatch& second) {
  std::vector<std::pair<int32_t, formats::aedat4::Bytes>> packets;
  for (const EventBatch* part : {&first, &second}) {
    size_t trigger = 0;
    for (size_t begin = 0; begin < part->events.size(); begin += 1000) {
      EventColumns events;
      events.append(part->events, begin, begin + 1000);
      std::vector<std::pair<int8_t, int64_t>> triggers;
      for (; trigger < part->triggers.size() && part->triggers[trigger].t <= events.t.back(); ++trigger) {
        triggers.emplace_back(part->triggers[trigger].p != 0 ? 1 : 2, part->triggers[trigger].t);
      }
      packets.emplace_back(0, formats::aedat4::event_packet(events));
      packets.emplace_back(3, formats::aedat4::trigger_packet(triggers));
    }
  }
  return formats::aedat4::make_file(packets, formats::aedat4::Compression::kLz4);
}

TEST(ContainersOfTwoParts, GoOnBehindTheEarlierPart) {
  const TestFolder folder;
  EventBatch first = part_of(60'000, 1000, 6'000'000, 1), second = part_of(60'000, 500, 7'000'000, 2);
  for (EventBatch* part : {&first, &second}) {
    for (Trigger& trigger : part->triggers) trigger.id = 0;
  }
  const Bytes dat = joined(first, second, "dat", false);
  const Bytes aedat4 = aedat4_of(first, second);
  for (const Bytes* bytes : {&dat, &aedat4}) {
    SCOPED_TRACE(bytes == &dat ? "dat" : "aedat4");
    int64_t shift_us = 0;
    const EventBatch expected = continued(first, second, shift_us, bytes != &dat);
    for (const size_t max_events : {RecordingReader::kDefaultBatch, size_t{64}, size_t{1000}}) {
      const Decoded decoded = decode(*bytes, 1, max_events);
      EXPECT_TRUE(decoded.batch == expected) << max_events;
      ASSERT_EQ(decoded.summary.num_restarts, 1U);
      EXPECT_EQ(decoded.summary.restarts[0].shift_us, shift_us);
      EXPECT_EQ(decoded.summary.num_violations(), 0U);
      if (bytes == &dat) {
        EXPECT_EQ(decoded.summary.restarts[0].byte, encoded(first, "dat").size());
      }
    }
    auto reader = open_bytes(*bytes, {.policy = DecodePolicy::kSkip}).value();
    EventBatch batch;
    for (const size_t i : {size_t{90'000}, size_t{30'000}, size_t{119'000}}) {
      const int64_t t_us = expected.events.t[i];
      const auto place = std::lower_bound(expected.events.t.begin(), expected.events.t.end(), t_us);
      ASSERT_TRUE(reader->seek(t_us));
      ASSERT_TRUE(reader->read(batch).value());
      EXPECT_EQ(batch.events[0], expected.events[static_cast<size_t>(place - expected.events.t.begin())]);
    }
  }
}

TEST(DatOfTwoParts, GoesOnBehindTheHeaderOfTheLaterOne) {
  const EventBatch first = part_of(40'000, 1000, 6'000'000, 1), second = part_of(40'000, 500, 7'000'000, 2);
  int64_t shift_us = 0;
  const EventBatch expected = continued(first, second, shift_us, false);
  const Bytes bytes = joined(first, second, "dat", true);
  EXPECT_TRUE(decode(bytes, 1).batch == expected);
  const Decoded pieces = decode(chunked(bytes, 501), 1);
  EXPECT_TRUE(pieces.batch == expected);
  EXPECT_EQ(pieces.summary.num_violations(), 0U);
}

TEST(DatOfThreeParts, GoesOnBehindAPartOfWhichNothingIsBelievable) {
  const EventBatch first = part_of(5'000, 1000, 6'000'000, 1), second = part_of(5'000, 500, 7'000'000, 2);
  Bytes bytes = joined(first, second, "dat", false);
  const size_t begin = bytes.size();
  const size_t header = header_bytes(bytes, "dat");
  const Bytes later(bytes.begin() + static_cast<ptrdiff_t>(header + 8 * first.events.size()), bytes.end());
  bytes.insert(bytes.end(), later.begin(), later.end());
  // Columns of the part in the middle are beyond the sensor.
  for (size_t at = begin - later.size(); at < begin; at += 8) bytes[at + 5] |= 0x20;
  int64_t shift_us = 0;
  const EventBatch expected = continued(first, second, shift_us, false);
  const Decoded decoded = decode(bytes, 1);
  EXPECT_TRUE(decoded.batch.events == expected.events);
  EXPECT_EQ(decoded.summary.num_restarts, 1U);
  EXPECT_EQ(decoded.summary.of(Violation::kOutOfRange).count, second.events.size());
}

TEST(Aedat4OfTwoParts, GoesOnBehindTheHeaderOfTheLaterOne) {
  const EventBatch first = part_of(6'000, 1000, 600'000, 1), second = part_of(6'000, 500, 700'000, 2);
  Bytes bytes = aedat4_of(first, EventBatch());
  const Bytes later = aedat4_of(second, EventBatch());
  bytes.insert(bytes.end(), later.begin(), later.end());
  int64_t shift_us = 0;
  const EventBatch expected = continued(first, second, shift_us);
  const Decoded decoded = decode(bytes, 1);
  EXPECT_TRUE(decoded.batch.events == expected.events);
  EXPECT_EQ(decoded.summary.num_violations(), 0U);
}

TEST(DatOfTwoParts, TakesTheTriggersOfEachPartFromTheFileBesideIt) {
  const TestFolder folder;
  const EventBatch first = part_of(60'000, 1000, 6'000'000, 1), second = part_of(60'000, 500, 6'000'000, 2);
  const auto write = [&](const EventBatch& batch, const std::string& name) {
    write_recording(folder / name, batch, {.width = 640, .height = 480}, "dat");
  };
  const auto append_records = [&](const std::string& from, const std::string& to) {
    const auto later = read_file(folder / from).value();
    const auto begin = std::search(later.begin(), later.end(), std::begin("% end"), std::begin("% end") + 5) + 8;
    std::ofstream file(folder / to, std::ios::app | std::ios::binary);
    file.write(reinterpret_cast<const char*>(&*begin), later.end() - begin);
  };
  write(first, "a.dat");
  write(second, "b.dat");
  append_records("b.dat", "a.dat");
  append_records("b_trigger.dat", "a_trigger.dat");
  int64_t shift_us = 0;
  const EventBatch expected = continued(first, second, shift_us);
  auto reader = open_recording(folder / "a.dat").value();
  const EventBatch all = read_all(*reader).value();
  EXPECT_TRUE(all.events == expected.events);
  EXPECT_TRUE(all.triggers == expected.triggers);
  EXPECT_EQ(reader->summary().num_violations(), 0U);
}

/// Reads all of a text whose events are these, in this order.
Decoded decode_text(const std::vector<Event>& events, RestartPolicy restart = RestartPolicy::kContinue) {
  std::string text = "x,y,p,t\n";
  for (const Event& event : events) text += cat(event.x, ",", event.y, ",", int{event.p}, ",", event.t, "\n");
  OpenOptions options = {.policy = DecodePolicy::kSkip, .restart = restart};
  return decoded(open_recording(make_memory_source(std::vector<uint8_t>(text.begin(), text.end()), "text"), options));
}

std::vector<Event> events_of(const EventBatch& batch) {
  std::vector<Event> events;
  for (size_t i = 0; i < batch.events.size(); ++i) events.push_back(batch.events[i]);
  return events;
}

TEST(JoinedTexts, GoOnBehindTheEarlierPartAndAreNotMixed) {
  const EventBatch first = part_of(3'000, 1000, 600'000, 1), second = part_of(2'000, 500, 900'000, 2);
  std::vector<Event> both = events_of(first);
  const std::vector<Event> later = events_of(second);
  both.insert(both.end(), later.begin(), later.end());
  const int64_t shift_us = first.events.t.back() + 1 - second.events.t.front();
  const Decoded decoded = decode_text(both);
  ASSERT_EQ(decoded.summary.num_restarts, 1U);
  EXPECT_EQ(decoded.summary.restarts[0].shift_us, shift_us);
  EXPECT_EQ(decoded.summary.out_of_order, 0U);
  EXPECT_TRUE(decode_text(both, RestartPolicy::kSplit).batch.events == first.events);
  for (size_t i = first.events.size(); i < both.size(); ++i) both[i].t += shift_us;
  EXPECT_TRUE(events_of(decoded.batch) == both);
}

TEST(ImpossibleTimes, AreLeftOutAndCounted) {
  const EventBatch first = part_of(3'000, 1000, 600'000, 1), second = part_of(2'000, 500, 900'000, 2);
  std::vector<Event> all = events_of(first);
  const std::vector<Event> later = events_of(second);
  all.insert(all.end(), later.begin(), later.end());
  const auto place = all.begin() + static_cast<ptrdiff_t>(first.events.size());
  all.insert(place, 100, Event{1, 1, 1, 9'151'595'965'040'361'472});
  const Decoded decoded = decode_text(all);
  int64_t shift_us = 0;
  EXPECT_TRUE(decoded.batch.events == continued(first, second, shift_us, false).events);
  EXPECT_EQ(decoded.summary.num_violations(), 100U);
}

TEST(DamagedTimes, OfDatAreNoRestarts) {
  const EventBatch part = part_of(50'000, 1000, 6'000'000, 1);
  Bytes bytes = encoded(part, "dat");
  const size_t header = header_bytes(bytes, "dat");
  // Single times far ahead and far behind, and a stretch of zeros.
  for (size_t i = 1000; i < 40'000; i += 777) bytes[header + 8 * i + 2] ^= 0x20;
  std::fill_n(bytes.begin() + static_cast<ptrdiff_t>(header + 8 * 41'000), 8 * 300, uint8_t{0});
  const Decoded decoded = decode(bytes, 1);
  EXPECT_EQ(decoded.summary.num_restarts, 0U);
  EXPECT_EQ(decoded.batch.events.t.back(), part.events.t.back());
}

TEST(SmallStepsBack, AreNoRestarts) {
  // One glitch of each kind: a TIME_HIGH word that falls by one step for a while, one that falls by seconds once.
  const EventBatch part = part_of(50'000, 1000, 500'000, 1);
  Bytes bytes = encoded(part, "evt3");
  const size_t header = header_bytes(bytes, "evt3");
  size_t highs = 0, changed = 0;
  for (size_t at = header; at + 1 < bytes.size(); at += 2) {
    if (bytes[at + 1] >> 4 != 8) continue;
    ++highs;
    const auto high = static_cast<uint32_t>((bytes[at + 1] & 0xF) << 8 | bytes[at]);
    const bool is_step = highs >= 2000 && highs < 2006 && high > 0;
    if (!is_step && highs != 5000) continue;
    const uint32_t lower = (high - (is_step ? 1 : 40)) & 0xFFF;
    bytes[at] = static_cast<uint8_t>(lower);
    bytes[at + 1] = static_cast<uint8_t>(0x80 | lower >> 8);
    ++changed;
  }
  ASSERT_EQ(changed, 7U);
  const Decoded decoded = decode(bytes, 1);
  EXPECT_EQ(decoded.summary.num_restarts, 0U);
  EXPECT_GT(decoded.summary.of(Violation::kTimeBackwards).count, 0U);
  EXPECT_EQ(decoded.batch.events.t.back(), part.events.t.back());
  // Each event is there or counted.
  EXPECT_EQ(decoded.batch.events.size() + decoded.batch.triggers.size() + decoded.summary.events_unplaced,
            part.events.size() + part.triggers.size());
}

TEST(Evt3Reports, CountsOfTheSensorAreSummed) {
  // TIME_HIGH, TIME_LOW, OTHERS 0x14 with 0x1002003 (28 bits), OTHERS 0x16 with 5 (24 bits), Y, X.
  const Bytes bytes = {0x01, 0x80, 0x02, 0x60, 0x14, 0xe0, 0x03, 0xf0, 0x02, 0xf0, 0x01,
                       0x70, 0x16, 0xe0, 0x05, 0xf0, 0x00, 0xf0, 0x02, 0x00, 0x03, 0x20};
  OpenOptions options = {.format = "evt3", .counts_reports = true};
  auto reader = open_bytes(bytes, options).value();
  EXPECT_EQ(read_all(*reader).value().events.size(), 1U);
  EXPECT_EQ(reader->summary().sensor_events_in, 0x1002003U);
  EXPECT_EQ(reader->summary().sensor_events_sent, 5U);
}

TEST(Evt3Frames, PaddingBehindTheEndOfAMipiFrameChangesNothing) {
  // TIME_HIGH 1, TIME_LOW 2, Y 5, a hundred times X 3; end of frame with a payload, 1,000 zeros; TIME_HIGH 1, TIME_LOW
  // 3, X 4.
  Bytes bytes = {0x01, 0x80, 0x02, 0x60, 0x05, 0x00};
  for (int i = 0; i < 100; ++i) bytes.insert(bytes.end(), {0x03, 0x20});
  bytes.insert(bytes.end(), {0x19, 0xe0, 0x42, 0xfc, 0x00, 0xf0});
  bytes.resize(bytes.size() + 2000);
  bytes.insert(bytes.end(), {0x01, 0x80, 0x03, 0x60, 0x04, 0x20});
  OpenOptions options = {.format = "evt3", .policy = DecodePolicy::kStrict};
  for (const size_t step : {size_t{7}, size_t{5000}}) {
    auto reader = open_recording(chunked(bytes, step), options).value();
    const auto all = read_all(*reader);
    ASSERT_TRUE(all) << all.error().text();
    ASSERT_EQ(all->events.size(), 101U);
    EXPECT_EQ(all->events[100], (Event{4, 5, 0, 0x1003}));
  }
}

}  // namespace
}  // namespace e2lf::recordings
