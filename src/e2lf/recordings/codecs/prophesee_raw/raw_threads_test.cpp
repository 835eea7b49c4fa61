// SPDX-License-Identifier: MIT
// Decoding on several threads gives exactly what one thread gives: events, triggers, summary, images, seeks.
#include <gtest/gtest.h>

#include "bench/decode/benchmark_streams.h"
#include "e2lf/base/isa.h"
#include "e2lf/files/file.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_header.h"
#include "testing/chunked_source.h"
#include "testing/damage.h"
#include "testing/test_streams.h"

namespace e2lf::recordings {
namespace {

OpenOptions with_threads(int threads) {
  return {.policy = DecodePolicy::kSkip, .threads = threads};
}

Decoded decode(SourcePtr source, const OpenOptions& options, size_t max_events = 0) {
  EventBatch all;
  auto reader = open_recording(std::move(source), options).value();
  EventBatch batch;
  size_t last_size = RecordingReader::kDefaultBatch;
  while (reader->read(batch, max_events == 0 ? last_size : max_events).value()) {
    EXPECT_LE(batch.events.size(), max_events == 0 ? last_size : max_events);
    if (max_events != 0) max_events += 97;
    all.append(batch);
  }
  return {std::move(all), reader->summary()};
}

Decoded decode(std::span<const uint8_t> bytes, const OpenOptions& options, size_t max_events = 0) {
  return decode(make_memory_source(bytes), options, max_events);
}

/// What the scalar reference on one thread gives.
Decoded reference(std::span<const uint8_t> bytes, OpenOptions options) {
  options.threads = 1;
  EXPECT_TRUE(set_max_isa("scalar"));
  Decoded decoded = decode(bytes, options);
  EXPECT_TRUE(set_max_isa(""));
  return decoded;
}

/// Says where two results differ, without printing millions of events.
void expect_same(const Decoded& found, const Decoded& expected, const std::string& what) {
  SCOPED_TRACE(what);
  ASSERT_EQ(found.batch.events.size(), expected.batch.events.size());
  if (found.batch.events != expected.batch.events) {
    size_t first = 0;
    while (found.batch.events[first] == expected.batch.events[first]) ++first;
    ADD_FAILURE() << "event " << first << " differs";
  }
  EXPECT_TRUE(found.batch.triggers == expected.batch.triggers);
  EXPECT_EQ(found.summary.dropped_words, expected.summary.dropped_words);
  EXPECT_EQ(found.summary.events_before_time, expected.summary.events_before_time);
  EXPECT_EQ(found.summary.time_loops, expected.summary.time_loops);
  EXPECT_EQ(found.summary.num_gaps, expected.summary.num_gaps);
  EXPECT_TRUE(found.summary.gaps == expected.summary.gaps);
  for (size_t i = 0; i < kNumViolations; ++i) {
    EXPECT_EQ(found.summary.violations[i].count, expected.summary.violations[i].count) << i;
    EXPECT_EQ(found.summary.violations[i].first_byte, expected.summary.violations[i].first_byte) << i;
  }
  EXPECT_TRUE(found.summary == expected.summary);
}

/// As many events of a shape as make about so many bytes.
bench::BenchmarkStream stream_of(bench::StreamShape shape, uint64_t bytes) {
  constexpr double kBytesPerEvent[] = {2.7, 8.2, 0.9, 4, 0.5};
  return bench::synthesise_stream(
      shape, static_cast<uint64_t>(static_cast<double>(bytes) / kBytesPerEvent[static_cast<size_t>(shape)]));
}

/// A source that can be sought but gives hardly more than what was asked for.
class StingySource final : public ByteSource {
 public:
  StingySource(std::span<const uint8_t> bytes, size_t step) : bytes_(bytes), step_(step) {}
  Result<std::span<const uint8_t>> fetch(size_t wanted) override {
    const size_t left = bytes_.size() - position_;
    return bytes_.subspan(position_, std::min(left, (wanted + step_ - 1) / step_ * step_));
  }
  void consume(size_t count) override { position_ += count; }
  uint64_t position() const override { return position_; }
  Result<void> seek(uint64_t position) override {
    position_ = static_cast<size_t>(position);
    return {};
  }
  bool seekable() const override { return true; }
  std::optional<uint64_t> size() const override { return std::nullopt; }
  std::string name() const override { return "stingy"; }

 private:
  std::span<const uint8_t> bytes_;
  size_t step_;
  size_t position_ = 0;
};

void expect_threads_equal(std::span<const uint8_t> bytes, OpenOptions options) {
  const Decoded expected = reference(bytes, options);
  for (const int threads : {1, 2, 3, 8}) {
    options.threads = threads;
    const std::string what = std::to_string(threads) + " threads";
    expect_same(decode(bytes, options), expected, what);
    expect_same(decode(bytes, options, 64), expected, what + ", small batches");
    expect_same(decode(std::make_unique<StingySource>(bytes, 1), options), expected, what + ", stingy source");
  }
}

/// All recordings, the faulty ones too.
std::vector<std::filesystem::path> recordings() {
  std::vector<std::filesystem::path> paths;
  for (const char* folder : {"events", "events/fault"}) {
    const auto path = data_file(folder);
    if (path.empty()) continue;
    for (const auto& entry : std::filesystem::directory_iterator(path)) {
      if (entry.path().extension() == ".raw") paths.push_back(entry.path());
    }
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

TEST(RawThreads, EveryRecordingGivesWhatTheScalarReferenceGives) {
  const auto paths = recordings();
  if (paths.empty()) GTEST_SKIP() << "E2LF_DATA has no recordings";
  for (const auto& path : paths) {
    SCOPED_TRACE(path.filename());
    const auto bytes = read_file(path).value();
    OpenOptions options = with_threads(1);
    if (path.filename() == "no_header.raw") options.format = "evt3";
    expect_threads_equal(bytes, options);
  }
}

class Shapes : public testing::TestWithParam<bench::StreamShape> {};

TEST_P(Shapes, LongStreamsGiveWhatTheScalarReferenceGives) {
  const bench::BenchmarkStream stream = stream_of(GetParam(), 2'000'000);
  expect_threads_equal(stream.bytes, with_threads(1));
}

TEST_P(Shapes, DamagedStreamsGiveWhatTheScalarReferenceGives) {
  const bench::BenchmarkStream stream = stream_of(GetParam(), 800'000);
  const size_t header = parse_raw_header(stream.bytes, true, "").value().num_bytes;
  std::mt19937 random(static_cast<uint32_t>(GetParam()));
  uint64_t violations = 0;
  for (int trial = 0; trial < 8; ++trial) {
    SCOPED_TRACE(trial);
    auto bytes = stream.bytes;
    const int places = trial < 4 ? 3 : 40;
    const size_t size = trial % 3 == 0 ? 1 : trial % 3 == 1 ? 30 : 40'000;
    for (int i = 0; i < places; ++i) {
      damage(bytes, header, static_cast<Damage>(random() % (kNumDamages - 1)), size, random);
    }
    const Decoded expected = reference(bytes, with_threads(1));
    violations += expected.summary.num_violations();
    for (const int threads : {1, 2, 8}) {
      expect_same(decode(bytes, with_threads(threads)), expected, std::to_string(threads));
      expect_same(decode(std::make_unique<StingySource>(bytes, 37), with_threads(threads)), expected, "stingy");
    }
    expect_same(decode(chunked(bytes, 1 + random() % 50'000), with_threads(1)), expected, "chunks");
  }
  EXPECT_GT(violations, 20u);
}

TEST_P(Shapes, WrongSensorSizeIsReportedAlike) {
  const bench::BenchmarkStream stream = stream_of(GetParam(), 800'000);
  const size_t header = parse_raw_header(stream.bytes, true, "").value().num_bytes;
  OpenOptions options = with_threads(1);
  options.format = parse_raw_header(stream.bytes, true, "").value().info.format;
  options.width = 1000;
  options.height = 720;
  const auto payload = std::span(stream.bytes).subspan(header);
  const Decoded expected = reference(payload, options);
  EXPECT_GT(expected.summary.of(Violation::kOutOfRange).count, 1000u);
  for (const int threads : {1, 2, 3, 8}) {
    options.threads = threads;
    expect_same(decode(payload, options), expected, std::to_string(threads));
  }
}

TEST_P(Shapes, SeeksFindTheSameEvent) {
  const bench::BenchmarkStream stream = stream_of(GetParam(), 5'000'000);
  const Decoded whole = reference(stream.bytes, with_threads(1));
  const EventColumns& events = whole.batch.events;
  for (const int threads : {1, 3}) {
    SCOPED_TRACE(threads);
    auto reader = open_bytes(stream.bytes, with_threads(threads)).value();
    EventBatch batch;
    while (reader->read(batch).value()) continue;  // all checkpoints
    for (const size_t i : {events.size() - 1, size_t{17}, events.size() / 2, events.size() / 2 + 1000}) {
      const int64_t t_us = events.t[i];
      const auto first =
          static_cast<size_t>(std::lower_bound(events.t.begin(), events.t.end(), t_us) - events.t.begin());
      ASSERT_TRUE(reader->seek(t_us));
      for (size_t k = first; k < std::min(first + 150'000, events.size()); k += batch.events.size()) {
        ASSERT_TRUE(reader->read(batch).value());
        EventColumns expected;
        expected.append(events, k, k + batch.events.size());
        ASSERT_TRUE(batch.events == expected) << k;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Raw, Shapes, testing::ValuesIn(bench::kStreamShapes),
                         [](const auto& test) { return "n" + std::to_string(test.index); });

TEST(RawThreads, ClockThatWrapsAndStopsGoesOn) {
  for (const std::string format : {"evt3", "evt2", "evt2.1"}) {
    SCOPED_TRACE(format);
    // 225 s: 13 loops of the 24-bit clock.
    EventBatch batch = random_stream({.events = 300'000, .max_gap_us = 1500, .trigger_every = 500});
    for (size_t i = batch.events.size() / 2; i < batch.events.size(); ++i) batch.events.t[i] += 40'000'000;
    const int64_t half_us = batch.events.t[batch.events.size() / 2] - 40'000'000;
    for (Trigger& trigger : batch.triggers) trigger.t += trigger.t >= half_us ? 40'000'000 : 0;
    const std::vector<uint8_t> bytes = encoded(batch, format);
    const Decoded expected = reference(bytes, with_threads(1));
    EXPECT_TRUE(expected.batch == batch);
    for (const int threads : {2, 8})
      expect_same(decode(bytes, with_threads(threads)), expected, std::to_string(threads));
  }
}

TEST(RawThreads, StrictPolicyFailsAtTheSameByte) {
  bench::BenchmarkStream stream = bench::synthesise_stream(bench::StreamShape::kEvt3Dense, 1'000'000);
  stream.bytes[stream.bytes.size() / 2] ^= 0x40;
  stream.bytes.erase(stream.bytes.begin() + static_cast<ptrdiff_t>(stream.bytes.size() * 2 / 3));
  std::vector<std::string> errors;
  for (const int threads : {1, 2, 8}) {
    OpenOptions options = with_threads(threads);
    options.policy = DecodePolicy::kStrict;
    auto reader = open_bytes(stream.bytes, options).value();
    const auto batch = read_all(*reader);
    ASSERT_FALSE(batch);
    errors.push_back(batch.error().text());
  }
  EXPECT_EQ(errors[1], errors[0]);
  EXPECT_EQ(errors[2], errors[0]);
}

}  // namespace
}  // namespace e2lf::recordings
