// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <gtest/gtest.h>
#include <random>

#include "e2lf/files/file.h"
#include "e2lf/recordings/open/registry.h"
#include "testing/chunked_source.h"
#include "testing/test_streams.h"

/// What every container format that we read and write must do.
namespace e2lf::recordings {
namespace {

struct Format {
  std::string name;
  std::string file;
  bool keeps_size;             ///< the file says how large the sensor is
  bool has_checksums = false;  ///< damage is noticed and the file refused
};

void PrintTo(const Format& format, std::ostream* out) {
  *out << format.name;
}

class Container : public testing::TestWithParam<Format> {
 protected:
  std::filesystem::path path() const { return folder_ / GetParam().file; }

  Result<void> write(const EventBatch& batch, size_t step = SIZE_MAX) const {
    E2LF_ASSIGN_OR_RETURN(auto writer, create_recording(path(), GetParam().name, info_));
    size_t trigger = 0;
    for (size_t i = 0; i == 0 || i < batch.events.size(); i += step) {
      EventBatch part;
      const size_t end = step > batch.events.size() - i ? batch.events.size() : i + step;
      part.events.append(batch.events, i, end);
      for (; trigger < batch.triggers.size() &&
             (end == batch.events.size() || batch.triggers[trigger].t <= part.events.t.back());
           ++trigger) {
        part.triggers.push_back(batch.triggers[trigger]);
      }
      E2LF_RETURN_IF_ERROR(writer->write(part));
      if (end == batch.events.size()) break;
    }
    holds_triggers_ = writer->holds_triggers();
    return writer->finish();
  }

  Result<EventBatch> read(const OpenOptions& options = {}, size_t max_events = RecordingReader::kDefaultBatch,
                          DecodeSummary* summary = nullptr) const {
    E2LF_ASSIGN_OR_RETURN(auto reader, open_recording(path(), options));
    EventBatch all, batch;
    for (;;) {
      E2LF_ASSIGN_OR_RETURN(const bool more, reader->read(batch, max_events));
      if (!more) break;
      EXPECT_LE(batch.events.size(), max_events);
      all.append(batch);
    }
    if (summary != nullptr) *summary = reader->summary();
    return all;
  }

  EventBatch kept(EventBatch batch) const {
    if (!holds_triggers_) batch.triggers.clear();
    return batch;
  }

  TestFolder folder_;
  RecordingInfo info_ = {.width = 640, .height = 480, .header = {{"serial_number", "12"}}};
  mutable bool holds_triggers_ = false;
};

TEST_P(Container, RandomStreamsComeBackForAnyBatchSizes) {
  const EventBatch stream = random_stream({.events = 60000, .trigger_every = 700});
  for (const size_t write_step : {size_t{60000}, size_t{17001}, size_t{999}}) {
    ASSERT_TRUE(write(stream, write_step).ok());
    for (const size_t read_step : {size_t{64}, size_t{1000}, RecordingReader::kDefaultBatch}) {
      DecodeSummary summary;
      auto back = read({}, read_step, &summary);
      ASSERT_TRUE(back.ok()) << back.error().text();
      EXPECT_TRUE(*back == kept(stream)) << write_step << " " << read_step << " " << back->events.size() << " "
                                         << back->triggers.size();
      EXPECT_EQ(summary.num_violations(), 0u);
      EXPECT_EQ(summary.events(), stream.events.size());
    }
  }
}

TEST_P(Container, ManyThreadsReadTheSame) {
  const EventBatch stream = random_stream({.events = 300000, .max_gap_us = 3});
  ASSERT_TRUE(write(stream).ok());
  auto back = read({.threads = 0});
  ASSERT_TRUE(back.ok());
  EXPECT_TRUE(*back == stream);
}

TEST_P(Container, MemoryAndPipesReadTheSame) {
  const EventBatch stream = random_stream({.events = 70000});
  ASSERT_TRUE(write(stream).ok());
  auto bytes = read_file(path());
  ASSERT_TRUE(bytes.ok());
  FILE* pipe = ::popen(("cat '" + path().string() + "'").c_str(), "r");
  ASSERT_NE(pipe, nullptr);
  std::vector<SourcePtr> sources;
  sources.push_back(make_memory_source(std::span<const uint8_t>(*bytes)));
  sources.push_back(make_descriptor_source(::fileno(pipe), /*owned=*/false, "pipe"));
  for (auto& source : sources) {
    OpenOptions options = {.format = GetParam().name};
    auto reader = open_recording(std::move(source), options);
    ASSERT_TRUE(reader.ok()) << reader.error().text();
    auto back = read_all(**reader);
    ASSERT_TRUE(back.ok()) << back.error().text();
    EXPECT_TRUE(back->events == stream.events);
  }
  ::pclose(pipe);
}

TEST_P(Container, CutAtEveryByteReadsTheSame) {
  const EventBatch stream = random_stream({.events = 70, .trigger_every = 9});
  ASSERT_TRUE(write(stream).ok());
  const auto bytes = read_file(path()).value();
  const size_t step = std::max<size_t>(1, bytes.size() / 4000);
  for (size_t cut = 1; cut < bytes.size(); cut += step) {
    for (const size_t piece : {bytes.size(), size_t{5}}) {
      if (piece == 5 && cut % 50 != 1) continue;
      auto source = std::make_unique<ChunkedSource>(bytes, std::vector<size_t>{cut}, piece);
      auto reader = open_recording(std::move(source), {.format = GetParam().name});
      ASSERT_TRUE(reader.ok()) << reader.error().text();
      const auto back = read_all(**reader);
      ASSERT_TRUE(back.ok()) << back.error().text();
      ASSERT_TRUE(back->events == stream.events) << cut << " " << piece;
    }
  }
}

TEST_P(Container, SizeAndFormatAreFoundAgain) {
  ASSERT_TRUE(write(random_stream({.events = 10})).ok());
  auto reader = open_recording(path());
  ASSERT_TRUE(reader.ok()) << reader.error().text();
  EXPECT_EQ((*reader)->info().format, GetParam().name);
  EXPECT_EQ((*reader)->info().width, GetParam().keeps_size ? 640u : 0u);
  EXPECT_EQ((*reader)->info().height, GetParam().keeps_size ? 480u : 0u);
}

TEST_P(Container, EmptyRecordingComesBackEmpty) {
  ASSERT_TRUE(write({}).ok());
  auto back = read();
  ASSERT_TRUE(back.ok()) << back.error().text();
  EXPECT_TRUE(back->empty());
}

TEST_P(Container, ZeroTimeOriginShiftsEventsAndTriggersAlike) {
  EventBatch stream = random_stream({.events = 500, .begin_us = 777000, .trigger_every = 50});
  ASSERT_TRUE(write(stream).ok());
  auto back = read({.time = TimeOrigin::kZero});
  ASSERT_TRUE(back.ok());
  const int64_t first_us = stream.events.t.front();
  for (int64_t& t : stream.events.t) t -= first_us;
  for (Trigger& trigger : stream.triggers) trigger.t -= first_us;
  EXPECT_TRUE(*back == kept(stream));
}

TEST_P(Container, SeekGoesToTheFirstEventAtOrAfterATime) {
  const EventBatch stream = random_stream({.events = 100000, .trigger_every = 900});
  ASSERT_TRUE(write(stream).ok());
  auto reader = open_recording(path());
  ASSERT_TRUE(reader.ok());
  EventBatch batch;
  for (const size_t target : {70000, 100, 99999, 0, 40000}) {
    const int64_t t_us = stream.events.t[target];
    ASSERT_TRUE((*reader)->seek(t_us).ok());
    ASSERT_TRUE((*reader)->read(batch, 64).ok());
    const auto first = std::lower_bound(stream.events.t.begin(), stream.events.t.end(), t_us);
    ASSERT_FALSE(batch.events.empty());
    EXPECT_EQ(batch.events[0], stream.events[static_cast<size_t>(first - stream.events.t.begin())]) << target;
  }
}

TEST_P(Container, SliceOfTimeIsTheSameFromAFileAndAStream) {
  const EventBatch stream = random_stream({.events = 100000, .trigger_every = 900});
  ASSERT_TRUE(write(stream).ok());
  const auto bytes = read_file(path()).value();
  OpenOptions options{.format = GetParam().name, .from_us = stream.events.t[61234], .to_us = stream.events.t[61999]};
  const auto begin = std::lower_bound(stream.events.t.begin(), stream.events.t.end(), options.from_us);
  const auto end = std::lower_bound(stream.events.t.begin(), stream.events.t.end(), options.to_us);
  EventColumns expected;
  expected.append(stream.events, static_cast<size_t>(begin - stream.events.t.begin()),
                  static_cast<size_t>(end - stream.events.t.begin()));
  EXPECT_TRUE(read(options)->events == expected);
  auto live = open_recording(chunked(bytes, 100003), options);
  ASSERT_TRUE(live.ok()) << live.error().text();
  EXPECT_TRUE(read_all(**live)->events == expected);
  // The slice is of the sensor's clock, whatever times are handed out, or since the first event.
  const int64_t first_us = stream.events.t.front();
  OpenOptions since_first = options;
  since_first.range = TimeOrigin::kZero;
  since_first.from_us -= first_us;
  since_first.to_us -= first_us;
  EXPECT_TRUE(read(since_first)->events == expected);
  options.time = since_first.time = TimeOrigin::kZero;
  for (int64_t& t : expected.t) t -= first_us;
  EXPECT_TRUE(read(options)->events == expected);
  EXPECT_TRUE(read(since_first)->events == expected);
}

TEST_P(Container, WriterRefusesWhatReadersCouldNotTrust) {
  const auto code = [&](std::initializer_list<Event> list) {
    EventBatch batch;
    for (const Event& event : list) batch.events.push_back(event);
    auto writer = create_recording(path(), GetParam().name, info_);
    EXPECT_TRUE(writer.ok());
    const auto written = (*writer)->write(batch);
    return written.ok() ? "" : error_code_name(written.error().code);
  };
  EXPECT_STREQ(code({{640, 0, 0, 0}}), "invalid_value");
  EXPECT_STREQ(code({{0, 480, 0, 0}}), "invalid_value");
  EXPECT_STREQ(code({{0, 0, 2, 0}}), "invalid_value");
  EXPECT_STREQ(code({{0, 0, 0, 9}, {0, 0, 0, 8}}), "invalid_value");
  EXPECT_FALSE(std::filesystem::exists(path())) << "an unfinished recording must not appear";
}

TEST_P(Container, EveryTruncationIsSurvived) {
  const EventBatch stream = random_stream({.events = 40, .trigger_every = 10});
  ASSERT_TRUE(write(stream).ok());
  auto bytes = read_file(path());
  ASSERT_TRUE(bytes.ok());
  const size_t step = std::max<size_t>(1, bytes->size() / 1500);
  for (size_t length = 0; length < bytes->size(); length += step) {
    ASSERT_TRUE(write_file(path(), std::span(*bytes).first(length)).ok());
    auto back = read({.policy = DecodePolicy::kSkip});
    if (!back.ok()) continue;
    EXPECT_LE(back->events.size(), stream.events.size()) << length;
    EXPECT_TRUE(std::is_sorted(back->events.t.begin(), back->events.t.end())) << length;
  }
}

TEST_P(Container, FlippedBitsCostLittleAndNeverTurnTimeBack) {
  const EventBatch stream = random_stream({.events = 3000, .max_gap_us = 100});
  ASSERT_TRUE(write(stream).ok());
  auto bytes = read_file(path());
  ASSERT_TRUE(bytes.ok());
  std::mt19937 random(11);
  size_t kept_events = 0, opened = 0;
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<uint8_t> damaged = *bytes;
    // The first quarter holds what the format needs to be recognised; the rest is data.
    const size_t begin = damaged.size() / 4;
    damaged[begin + random() % (damaged.size() - begin)] ^= static_cast<uint8_t>(1u << random() % 8);
    ASSERT_TRUE(write_file(path(), damaged).ok());
    auto back = read({.policy = DecodePolicy::kSkip});
    if (!back.ok()) continue;
    ++opened;
    kept_events += back->events.size();
    EXPECT_TRUE(std::is_sorted(back->events.t.begin(), back->events.t.end()));
    EXPECT_LE(back->events.size(), stream.events.size() + 10);
  }
  if (GetParam().has_checksums) {
    EXPECT_LT(opened, 30u);
    return;
  }
  ASSERT_GT(opened, 200u);
  EXPECT_GT(static_cast<double>(kept_events) / static_cast<double>(opened), 0.85 * 3000.0);
}

INSTANTIATE_TEST_SUITE_P(Formats, Container,
                         testing::Values(Format{"dat", "rec_cd.dat", true}, Format{"hdf5", "rec.hdf5", true},
                                         Format{"npz", "rec.npz", true, true}, Format{"csv", "rec.csv", true}),
                         [](const auto& format) { return format.param.name; });

}  // namespace
}  // namespace e2lf::recordings
