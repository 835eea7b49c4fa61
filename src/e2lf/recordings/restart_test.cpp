// SPDX-License-Identifier: MIT
// Recordings whose clock starts again, because the camera was restarted or files were joined.
#include "e2lf/recordings/restart.h"

#include <fstream>
#include <gtest/gtest.h>

#include "e2lf/files/file.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_header.h"
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

Bytes encode(const EventBatch& batch, const std::string& format) {
  RecordingInfo info;
  info.width = 640;
  info.height = 480;
  Bytes bytes;
  auto writer = create_recording(make_memory_sink(bytes), format, info).value();
  writer->write(batch).value();
  writer->finish().value();
  return bytes;
}

size_t header_bytes(const Bytes& bytes, const std::string& format) {
  if (format == "dat")
    return static_cast<size_t>(std::search(bytes.begin(), bytes.end(), "% end", "% end" + 5) - bytes.begin()) + 8;
  return parse_raw_header(bytes, true, "").value().num_bytes;
}

/// Two recordings in one file.
Bytes joined(const EventBatch& first, const EventBatch& second, const std::string& format, bool with_header) {
  Bytes bytes = encode(first, format);
  const Bytes later = encode(second, format);
  const size_t skipped = with_header ? 0 : header_bytes(later, format);
  bytes.insert(bytes.end(), later.begin() + static_cast<ptrdiff_t>(skipped), later.end());
  return bytes;
}

struct Decoded {
  EventBatch batch;
  DecodeSummary summary;
  bool operator==(const Decoded&) const = default;
};

Decoded decode(std::unique_ptr<ByteSource> source, int threads, size_t max_events = RecordingReader::kDefaultBatch) {
  OpenOptions options;
  options.policy = DecodePolicy::kSkip;
  options.threads = threads;
  auto reader = open_recording(std::move(source), options).value();
  Decoded decoded;
  EventBatch batch;
  while (reader->read(batch, max_events).value()) {
    decoded.batch.events.append(batch.events);
    decoded.batch.triggers.insert(decoded.batch.triggers.end(), batch.triggers.begin(), batch.triggers.end());
  }
  decoded.summary = reader->summary();
  return decoded;
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
  first.events.append(later.events);
  first.triggers.insert(first.triggers.end(), later.triggers.begin(), later.triggers.end());
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
    const Decoded chunked = decode(std::make_unique<ChunkedSource>(bytes_, std::vector<size_t>(), step), 1);
    EXPECT_TRUE(chunked.batch == expected) << step;
    EXPECT_EQ(chunked.summary.restarts, one.summary.restarts) << step;
  }
}

TEST_P(ClockThatStartsAgain, CanBeSought) {
  int64_t shift_us = 0;
  const EventBatch expected = continued(first_, second_, shift_us, has_triggers_);
  auto reader =
      open_recording(make_memory_source(std::span<const uint8_t>(bytes_)), {.policy = DecodePolicy::kSkip}).value();
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
  OpenOptions options;
  options.policy = DecodePolicy::kSkip;
  options.restart = RestartPolicy::kSplit;
  auto reader = open_recording(make_memory_source(std::span<const uint8_t>(bytes_)), options).value();
  for (EventBatch* part : {&first_, &second_}) {
    if (!has_triggers_) part->triggers.clear();
    EXPECT_TRUE(read_all(*reader).value() == *part);
    EXPECT_EQ(reader->summary().events(), part->events.size());
    EXPECT_EQ(reader->next_part().value(), part == &first_);
  }
}

TEST_P(ClockThatStartsAgain, CanBeRefused) {
  OpenOptions options;
  options.restart = RestartPolicy::kRefuse;
  auto reader = open_recording(make_memory_source(std::span<const uint8_t>(bytes_)), options).value();
  const auto all = read_all(*reader);
  ASSERT_FALSE(all);
  EXPECT_NE(all.error().text().find("the clock starts again"), std::string::npos) << all.error().text();
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
      Bytes bytes = encode(first, format);
      bytes.resize(bytes.size() - cut);
      const Bytes later = encode(second, format);
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
  Bytes bytes = encode(part, "evt3");
  const size_t place = bytes.size();
  const Bytes later = encode(part, "evt2");
  bytes.insert(bytes.end(), later.begin(), later.end());
  auto reader = open_recording(make_memory_source(std::span<const uint8_t>(bytes))).value();
  const auto all = read_all(*reader);
  ASSERT_FALSE(all);
  EXPECT_EQ(all.error().location, "memory: byte " + std::to_string(place));
}

TEST(SmallStepsBack, AreNoRestarts) {
  // One glitch of each kind: a TIME_HIGH word that falls by one step for a while, one that falls by seconds once.
  const EventBatch part = part_of(50'000, 1000, 500'000, 1);
  Bytes bytes = encode(part, "evt3");
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
  OpenOptions options;
  options.format = "evt3";
  options.counts_reports = true;
  auto reader = open_recording(make_memory_source(std::span<const uint8_t>(bytes)), options).value();
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
  OpenOptions options;
  options.format = "evt3";
  options.policy = DecodePolicy::kStrict;
  for (const size_t step : {size_t{7}, size_t{5000}}) {
    auto reader = open_recording(std::make_unique<ChunkedSource>(bytes, std::vector<size_t>(), step), options).value();
    const auto all = read_all(*reader);
    ASSERT_TRUE(all) << all.error().text();
    ASSERT_EQ(all->events.size(), 101U);
    EXPECT_EQ(all->events[100], (Event{4, 5, 0, 0x1003}));
  }
}

}  // namespace
}  // namespace e2lf::recordings
