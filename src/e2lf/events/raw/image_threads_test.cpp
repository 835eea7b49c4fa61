// SPDX-License-Identifier: MIT
// Counting events into images on several threads gives exactly what one thread gives.
#include <gtest/gtest.h>

#include "e2lf/base/file.h"
#include "e2lf/events/benchmark/benchmark_streams.h"
#include "e2lf/events/evt3/evt3_decoder.h"
#include "e2lf/events/raw/damage.h"
#include "e2lf/events/raw/image_parts.h"
#include "e2lf/events/raw/raw_header.h"
#include "e2lf/events/test_streams.h"

namespace e2lf::events {
namespace {

using Slices = std::vector<TimeSlice>;

struct ImageSize {
  size_t height;
  size_t width;
};
/// That of the streams, and one so small that images of a part's own pay for few bytes.
constexpr ImageSize kSizes[] = {{720, 1280}, {80, 100}};

/// Everything that accumulate() gives in calls one after the other, and the first events behind.
struct Counted {
  std::vector<EventImages> images;
  std::vector<Trigger> triggers;
  std::vector<bool> more;
  std::vector<DecodeSummary> summaries;
  EventBatch rest;
  bool rest_is_there = false;
};

OpenOptions with_threads(int threads) {
  OpenOptions options;
  options.policy = DecodePolicy::kSkip;
  options.threads = threads;
  return options;
}

Counted count(std::span<const uint8_t> bytes, const OpenOptions& options, const std::vector<Slices>& calls,
              ImageSize size) {
  Counted counted;
  auto reader = open_recording(make_memory_source(bytes), options).value();
  for (const Slices& slices : calls) {
    EventImages& images = counted.images.emplace_back(slices.size(), size.height, size.width);
    counted.more.push_back(reader->accumulate(slices, images, &counted.triggers).value());
    counted.summaries.push_back(reader->summary());
  }
  counted.rest_is_there = reader->read(counted.rest, 1000).value();
  return counted;
}

void expect_same(const Counted& found, const Counted& expected) {
  EXPECT_TRUE(found.images == expected.images);
  EXPECT_TRUE(found.triggers == expected.triggers);
  EXPECT_EQ(found.more, expected.more);
  for (size_t i = 0; i < expected.summaries.size(); ++i) {
    EXPECT_TRUE(found.summaries[i] == expected.summaries[i]) << "call " << i;
    EXPECT_EQ(found.summaries[i].events(), expected.summaries[i].events()) << "call " << i;
    EXPECT_EQ(found.summaries[i].num_violations(), expected.summaries[i].num_violations()) << "call " << i;
  }
  EXPECT_EQ(found.rest_is_there, expected.rest_is_there);
  const size_t events = std::min(found.rest.events.size(), expected.rest.events.size());
  for (size_t i = 0; i < events; ++i) ASSERT_TRUE(found.rest.events[i] == expected.rest.events[i]) << i;
}

void expect_threads_equal(std::span<const uint8_t> bytes, OpenOptions options, const std::vector<Slices>& calls,
                          ImageSize size) {
  options.threads = 1;
  const Counted expected = count(bytes, options, calls, size);
  for (const int threads : {2, 3, 8}) {
    SCOPED_TRACE(std::to_string(threads) + " threads");
    options.threads = threads;
    expect_same(count(bytes, options, calls, size), expected);
  }
}

DecodeSummary summary_of(std::span<const uint8_t> bytes, const OpenOptions& options) {
  auto reader = open_recording(make_memory_source(bytes), options).value();
  EventBatch batch;
  while (reader->read(batch).value()) continue;
  return reader->summary();
}

/// Calls with some slices each over the time of a recording, by chance with gaps between slices, and beyond its end.
std::vector<Slices> random_calls(const DecodeSummary& summary, size_t num_slices, std::mt19937& random) {
  const int64_t length_us = std::max<int64_t>(summary.last_t_us - summary.first_t_us, 100);
  const auto mean_us = static_cast<uint64_t>(length_us) / num_slices + 1;
  const auto any = [&](uint64_t most_us) { return static_cast<int64_t>(random() % (most_us + 1)); };
  std::vector<Slices> calls;
  int64_t t_us = summary.first_t_us + any(mean_us);
  while (t_us < summary.last_t_us + static_cast<int64_t>(mean_us)) {
    Slices& slices = calls.emplace_back();
    for (uint32_t i = 0; i < 1 + random() % 5; ++i) {
      if (random() % 3 == 0) t_us += any(mean_us / 4);
      const int64_t end_us = t_us + any(2 * mean_us);
      slices.push_back({t_us, end_us});
      t_us = end_us;
    }
    if (random() % 4 == 0) t_us += any(mean_us);
  }
  return calls;
}

void expect_threads_equal_for_any_slices(std::span<const uint8_t> bytes, const OpenOptions& options,
                                         std::mt19937& random) {
  const DecodeSummary summary = summary_of(bytes, options);
  expect_threads_equal(bytes, options, {{{summary.first_t_us, summary.last_t_us + 1}}}, kSizes[0]);
  for (const size_t num_slices : {3, 20, 300}) {
    const auto calls = random_calls(summary, num_slices, random);
    for (const ImageSize size : kSizes) {
      if (num_slices > 100 && size.width > 1000) continue;  // hundreds of images take too long to compare
      SCOPED_TRACE(std::to_string(num_slices) + " slices, width " + std::to_string(size.width));
      expect_threads_equal(bytes, options, calls, size);
    }
  }
}

std::vector<std::filesystem::path> recordings(const std::string& folder) {
  std::vector<std::filesystem::path> paths;
  const auto path = data_file(folder);
  if (path.empty()) return paths;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    if (entry.path().extension() == ".raw") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

TEST(ImageThreads, RepeatedRecordingsGiveWhatOneThreadGives) {
  const auto paths = recordings("events");
  if (paths.empty()) GTEST_SKIP() << "E2LF_DATA has no recordings";
  std::mt19937 random(1);
  for (const auto& path : paths) {
    SCOPED_TRACE(path.filename());
    const auto stream = repeat_recording(path, 1'500'000).value();
    expect_threads_equal_for_any_slices(stream.bytes, with_threads(1), random);
  }
}

TEST(ImageThreads, FaultyRecordingsGiveWhatOneThreadGives) {
  const auto paths = recordings("events/fault");
  if (paths.empty()) GTEST_SKIP() << "E2LF_DATA has no recordings";
  std::mt19937 random(2);
  for (const auto& path : paths) {
    SCOPED_TRACE(path.filename());
    OpenOptions options = with_threads(1);
    if (path.filename() == "no_header.raw") options.format = "evt3";
    expect_threads_equal_for_any_slices(read_file(path).value(), options, random);
  }
}

class ImageShapes : public testing::TestWithParam<StreamShape> {};

TEST_P(ImageShapes, AnySlicesGiveWhatOneThreadGives) {
  std::mt19937 random(static_cast<uint32_t>(GetParam()));
  const BenchmarkStream stream = synthesise_stream(GetParam(), 1'500'000);
  expect_threads_equal_for_any_slices(stream.bytes, with_threads(1), random);
}

TEST_P(ImageShapes, DamagedStreamsGiveWhatOneThreadGives) {
  std::mt19937 random(static_cast<uint32_t>(GetParam()));
  const BenchmarkStream stream = synthesise_stream(GetParam(), 1'500'000);
  const size_t header = parse_raw_header(stream.bytes, true, "").value().num_bytes;
  uint64_t violations = 0;
  for (int trial = 0; trial < 8; ++trial) {
    SCOPED_TRACE(trial);
    auto bytes = stream.bytes;
    const size_t size = trial % 3 == 0 ? 1 : trial % 3 == 1 ? 30 : 40'000;
    for (int i = 0; i < (trial < 4 ? 3 : 40); ++i) {
      damage(bytes, header, static_cast<Damage>(random() % (kNumDamages - 1)), size, random);
    }
    const DecodeSummary summary = summary_of(bytes, with_threads(1));
    violations += summary.num_violations();
    expect_threads_equal(bytes, with_threads(1), random_calls(summary, trial % 2 == 0 ? 3 : 30, random), kSizes[1]);
  }
  EXPECT_GT(violations, 20u);
}

INSTANTIATE_TEST_SUITE_P(Raw, ImageShapes, testing::ValuesIn(kStreamShapes),
                         [](const auto& test) { return "n" + std::to_string(test.index); });

TEST(ImageThreads, TriggersAndFullPixelsAreTheSame) {
  std::mt19937 random(3);
  for (const std::string format : {"evt3", "evt2", "evt2.1"}) {
    SCOPED_TRACE(format);
    RecordingInfo info;
    info.width = 640;
    info.height = 480;
    RandomStream options;
    options.events = 1'000'000;
    options.max_gap_us = 2;
    options.trigger_every = 50;
    EventBatch batch = random_stream(options);
    for (size_t i = 0; i < batch.events.size(); i += 2) {
      batch.events.x[i] = 70;
      batch.events.y[i] = 60;
      batch.events.p[i] = 1;
    }
    std::vector<uint8_t> bytes;
    auto writer = create_recording(make_memory_sink(bytes), format, info).value();
    writer->write(batch).value();
    writer->finish().value();
    expect_threads_equal_for_any_slices(bytes, with_threads(1), random);
    const auto counted = count(bytes, with_threads(4), {{{0, batch.events.t.back() + 1}}}, {480, 640});
    EXPECT_TRUE(counted.triggers == batch.triggers);
    EXPECT_EQ(counted.images[0].counts[60 * 640 + 70], 32767);
  }
}

/// An EVT2 recording whose times run back all along: events in any order within each 64 us.
std::vector<uint8_t> unsorted_recording(std::mt19937& random) {
  constexpr uint32_t kWindows = 300, kEventsPerWindow = 8000;
  const std::string header = "% evt 2.0\n% format EVT2;width=640;height=480\n% end\n";
  std::vector<uint8_t> bytes(header.begin(), header.end());
  const auto put = [&bytes](uint32_t word) {
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<uint8_t>(word >> shift));
  };
  for (uint32_t window = 0; window < kWindows; ++window) {
    for (uint32_t i = 0; i < kEventsPerWindow; ++i) {
      if (i % 400 == 0) put((8u << 28) | (1000 + window));
      const uint32_t type = i % 100 == 7 ? 0xAu : random() % 2;
      const uint32_t payload = type == 0xA ? 1 << 8 : ((random() % 640) << 11) | (random() % 480);
      put((type << 28) | ((random() % 64) << 22) | payload);
    }
  }
  return bytes;
}

TEST(ImageThreads, TimesThatRunBackAcrossSlicesAreRaisedTheSame) {
  std::mt19937 random(4);
  const auto bytes = unsorted_recording(random);
  const DecodeSummary summary = summary_of(bytes, with_threads(1));
  EXPECT_EQ(summary.num_violations(), 0u);
  EXPECT_GT(summary.events(), 2'300'000u);
  for (int trial = 0; trial < 10; ++trial) {
    SCOPED_TRACE(trial);
    const size_t num_slices = static_cast<size_t>(20 + 20 * trial);
    expect_threads_equal(bytes, with_threads(1), random_calls(summary, num_slices, random), kSizes[1]);
  }
}

TEST(ImageThreads, PartsOfAnUndamagedStreamAreTaken) {
  const BenchmarkStream stream = synthesise_stream(StreamShape::kEvt3Vector, 4'000'000);
  const DecodeSummary known = summary_of(stream.bytes, with_threads(1));
  const size_t header = parse_raw_header(stream.bytes, true, "").value().num_bytes;
  const auto bytes = std::span<const uint8_t>(stream.bytes).subspan(header);
  const SensorLimits limits{1280, 720};
  const Slices slices = {{known.first_t_us, known.last_t_us + 1}};
  EventImages images(1, 80, 100);
  ImageSink sink(slices, images, nullptr);
  RawStream<evt3::Codec> decoder(limits);
  DecodeSummary summary;
  constexpr size_t kBegin = 4096;
  ASSERT_EQ(decoder.process(bytes, false, 0, sink, summary, kBegin).used, kBegin);
  ImageParts<evt3::Codec> parts(4, limits);
  EXPECT_EQ(parts.plan(slices, images, sink.latest()), 0u) << "planned without knowing how fast time goes on";
  parts.learn(bytes.size(), known.first_t_us, known.last_t_us);
  const size_t wanted = parts.plan(slices, images, sink.latest());
  ASSERT_GT(wanted, 4u * 100'000);
  ASSERT_LT(wanted, bytes.size() + bytes.size() / 10);
  const auto window = bytes.subspan(kBegin, wanted / 2 + 200'000);
  const size_t used = parts.count({window, kBegin, slices}, images, decoder, sink, summary);
  EXPECT_GT(used, wanted / 2 - 200'000);
  EXPECT_EQ(summary.num_violations(), 0u);
}

}  // namespace
}  // namespace e2lf::events
