// SPDX-License-Identifier: MIT
#include <algorithm>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <numeric>
#include <thread>
#include <unistd.h>

#include "e2lf/base/isa.h"
#include "e2lf/files/file.h"
#include "e2lf/recordings/convert.h"
#include "testing/chunked_source.h"
#include "testing/test_streams.h"

namespace e2lf::recordings {
namespace {

/// The true counts and sums of a recording.
struct Anchor {
  const char* file;
  uint64_t on, off, triggers, rising;
  int64_t first_us, last_us, sum_t, sum_x, sum_y;
  uint16_t trigger_id = 0;
};

constexpr Anchor kAnchors[] = {
    {"evt3_gen41_1280x720.raw", 115532, 104064, 0, 0, 11718656, 11727457, 2574324900467, 159113225, 85638051},
    {"evt2_gen3_640x480.raw", 367855, 171626, 0, 0, 1317888, 1367888, 724340275912, 171811022, 110162026},
    {"evt3_hd_trigger_1280x720.raw", 41439, 41030, 2, 1, 14224870, 15476187, 1222326831810, 42078718, 31656267},
    {"evt3_vga_trigger_2khz_640x480.raw", 125183, 218291, 4157, 2079, 7139845, 9218023, 2851601611994, 116731888,
     80879209, 6},
    {"evt21_le_derived.raw", 115532, 104064, 2, 1, 11718656, 11727457, 2574324900467, 159113225, 85638051, 1},
    {"evt21_halfswapped_derived.raw", 115532, 104064, 2, 1, 11718656, 11727457, 2574324900467, 159113225, 85638051, 1},
};

std::filesystem::path event_file(const std::string& name) {
  return data_file("events/" + name);
}

template <typename Values>
int64_t sum(const Values& values) {
  return std::accumulate(values.begin(), values.end(), int64_t{0});
}

void expect_anchor(const EventBatch& batch, const Anchor& anchor) {
  const EventColumns& events = batch.events;
  ASSERT_EQ(events.size(), anchor.on + anchor.off);
  EXPECT_EQ(static_cast<uint64_t>(sum(events.p)), anchor.on);
  EXPECT_EQ(events.t.front(), anchor.first_us);
  EXPECT_EQ(events.t.back(), anchor.last_us);
  EXPECT_EQ(sum(events.t), anchor.sum_t);
  EXPECT_EQ(sum(events.x), anchor.sum_x);
  EXPECT_EQ(sum(events.y), anchor.sum_y);
  ASSERT_EQ(batch.triggers.size(), anchor.triggers);
  uint64_t rising = 0;
  for (const Trigger& trigger : batch.triggers) {
    rising += trigger.p;
    EXPECT_EQ(trigger.id, anchor.trigger_id);
  }
  EXPECT_EQ(rising, anchor.rising);
}

void expect_clean(const DecodeSummary& summary, const Anchor& anchor) {
  EXPECT_EQ(summary.events_on, anchor.on);
  EXPECT_EQ(summary.events_off, anchor.off);
  EXPECT_EQ(summary.triggers, anchor.triggers);
  EXPECT_EQ(summary.first_t_us, anchor.first_us);
  EXPECT_EQ(summary.last_t_us, anchor.last_us);
  EXPECT_EQ(summary.num_violations(), 0u);
  EXPECT_EQ(summary.num_gaps, 0u);
}

EventBatch read_whole(SourcePtr source, const OpenOptions& options = {}) {
  auto reader = open_recording(std::move(source), options).value();
  return read_all(*reader).value();
}

EventBatch read_whole(const std::filesystem::path& path, const OpenOptions& options = {}) {
  auto reader = open_recording(path, options).value();
  return read_all(*reader).value();
}

class Anchors : public testing::TestWithParam<Anchor> {
 protected:
  void SetUp() override {
    path_ = event_file(GetParam().file);
    E2LF_SKIP_WITHOUT(path_);
  }
  std::filesystem::path path_;
};

TEST_P(Anchors, FileGivesTrueCounts) {
  for (const std::string& isa : available_isas()) {
    SCOPED_TRACE(isa);
    ASSERT_TRUE(set_max_isa(isa));
    auto reader = open_recording(path_).value();
    expect_anchor(read_all(*reader).value(), GetParam());
    expect_clean(reader->summary(), GetParam());
  }
  ASSERT_TRUE(set_max_isa(""));
}

TEST_P(Anchors, ThreadsGiveTheSameEvents) {
  OpenOptions options = {.threads = 4};
  EXPECT_EQ(read_whole(path_, options), read_whole(path_));
}

TEST_P(Anchors, SmallAndOddBatchesGiveTheSameEvents) {
  const EventBatch whole = read_whole(path_);
  auto reader = open_recording(path_).value();
  EventBatch all, batch;
  for (size_t max_events = 64; reader->read(batch, max_events).value(); max_events += 13) {
    ASSERT_LE(batch.events.size(), max_events);
    ASSERT_LE(batch.triggers.size(), max_events);
    all.append(batch);
  }
  EXPECT_EQ(all, whole);
}

/// Small chunks on the beginning of a file: each costs as much as a large one.
TEST_P(Anchors, ChunksOfAnySizeGiveTheSameEvents) {
  const auto bytes = read_file(path_).value();
  const std::vector<uint8_t> begin(bytes.begin(),
                                   bytes.begin() + static_cast<ptrdiff_t>(std::min<size_t>(bytes.size(), 20'000)));
  const EventBatch whole = read_whole(path_);
  const EventBatch first = read_whole(make_memory_source(std::span<const uint8_t>(begin)));
  ASSERT_GT(first.events.size(), 100u);
  for (const size_t step : {1, 3, 7, 64}) {
    EXPECT_EQ(read_whole(chunked(begin, step)), first) << step;
  }
  for (const size_t step : {1001, 65'537}) {
    EXPECT_EQ(read_whole(chunked(bytes, step)), whole) << step;
  }
}

TEST_P(Anchors, CutAtEveryByteOfAPrefixGivesTheSameEvents) {
  auto bytes = read_file(path_).value();
  bytes.resize(2000);
  const EventBatch whole = read_whole(make_memory_source(std::span<const uint8_t>(bytes)));
  ASSERT_GT(whole.events.size(), 100u);
  for (size_t cut = 1; cut < bytes.size(); ++cut) {
    ASSERT_EQ(read_whole(std::make_unique<ChunkedSource>(bytes, std::vector<size_t>{cut}, bytes.size())), whole) << cut;
  }
}

TEST_P(Anchors, PipeGivesTrueCounts) {
  const auto bytes = read_file(path_).value();
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  std::thread feeder([&] {
    for (size_t done = 0; done < bytes.size();) {
      const ssize_t count = ::write(ends[1], bytes.data() + done, std::min<size_t>(bytes.size() - done, 5000));
      if (count <= 0) break;
      done += static_cast<size_t>(count);
    }
    ::close(ends[1]);
  });
  const EventBatch batch = read_whole(make_descriptor_source(ends[0], /*owned=*/true, "pipe"));
  feeder.join();
  expect_anchor(batch, GetParam());
}

TEST_P(Anchors, EveryContainerKeepsThem) {
  const TestFolder folder;
  for (const char* extension : {"csv", "dat", "hdf5", "npz"}) {
    SCOPED_TRACE(extension);
    auto reader = open_recording(path_).value();
    const auto copy = folder / (std::string("copy.") + extension);
    const auto report = convert_recording(*reader, copy);
    ASSERT_TRUE(report.ok()) << report.error().text();
    expect_anchor(read_whole(copy), GetParam());
    auto again = open_recording(copy, {.policy = DecodePolicy::kStrict, .threads = 0}).value();
    expect_anchor(read_all(*again).value(), GetParam());
    expect_clean(again->summary(), GetParam());
  }
}

TEST_P(Anchors, ZeroOriginShiftsEventsAndTriggersAlike) {
  OpenOptions options = {.time = TimeOrigin::kZero};
  const EventBatch absolute = read_whole(path_);
  const EventBatch shifted = read_whole(path_, options);
  int64_t shift_us = absolute.events.t.front();
  if (!absolute.triggers.empty()) shift_us = std::min(shift_us, absolute.triggers.front().t);
  ASSERT_EQ(shifted.events.size(), absolute.events.size());
  EXPECT_EQ(shifted.events.t.front(), absolute.events.t.front() - shift_us);
  EXPECT_EQ(shifted.events.t.back(), absolute.events.t.back() - shift_us);
  EXPECT_EQ(sum(shifted.events.t), sum(absolute.events.t) - shift_us * static_cast<int64_t>(absolute.events.size()));
  for (size_t i = 0; i < absolute.triggers.size(); ++i) {
    EXPECT_EQ(shifted.triggers[i].t, absolute.triggers[i].t - shift_us);
  }
}

TEST_P(Anchors, SeekFindsTheFirstEventOfATime) {
  const EventBatch whole = read_whole(path_);
  auto reader = open_recording(path_).value();
  for (const size_t i : {whole.events.size() / 2, size_t{5}, whole.events.size() - 1, size_t{0}}) {
    const int64_t t_us = whole.events.t[i];
    ASSERT_TRUE(reader->seek(t_us));
    size_t first = i;
    while (first > 0 && whole.events.t[first - 1] == t_us) --first;
    EventBatch batch;
    ASSERT_TRUE(reader->read(batch, 64).value());
    ASSERT_FALSE(batch.events.empty());
    for (size_t k = 0; k < batch.events.size(); ++k) ASSERT_EQ(batch.events[k], whole.events[first + k]);
  }
  int64_t end_us = whole.events.t.back() + 1;
  if (!whole.triggers.empty()) end_us = std::max(end_us, whole.triggers.back().t + 1);
  ASSERT_TRUE(reader->seek(end_us));
  EventBatch batch;
  EXPECT_FALSE(reader->read(batch).value());
}

TEST_P(Anchors, WrittenAgainInEveryEncodingReadsTheSame) {
  auto reader = open_recording(path_).value();
  const EventBatch whole = read_all(*reader).value();
  for (const std::string format : {"evt2", "evt2.1", "evt3"}) {
    const RecordingInfo info = reader->info();
    const std::vector<uint8_t> bytes = encoded(whole, format, info);
    auto again = open_bytes(bytes).value();
    EXPECT_EQ(again->info().format, format);
    EXPECT_EQ(again->info().width, info.width);
    EXPECT_EQ(again->info().height, info.height);
    EXPECT_EQ(again->info().find("serial_number"), info.find("serial_number"));
    EXPECT_EQ(read_all(*again).value(), whole) << format;
    EXPECT_EQ(again->summary().num_violations(), 0u) << format;
  }
}

TEST(Triggers, OfTheTwoKilohertzRecordingAre500UsApart) {
  const auto path = event_file("evt3_vga_trigger_2khz_640x480.raw");
  E2LF_SKIP_WITHOUT(path);
  const std::vector<Trigger> triggers = read_whole(path).triggers;
  for (size_t i = 1; i < triggers.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(triggers[i].t - triggers[i - 1].t), 500, 2) << i;
    EXPECT_NE(triggers[i].p, triggers[i - 1].p) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Recordings, Anchors, testing::ValuesIn(kAnchors),
                         [](const auto& test) { return "n" + std::to_string(test.index); });

/// A damaged or odd file, and what is left of it.
struct Fault {
  const char* file;
  size_t events, triggers;
};

class Faults : public testing::TestWithParam<Fault> {};

TEST_P(Faults, GiveWhatIsLeft) {
  const auto path = event_file(std::string("fault/") + GetParam().file);
  E2LF_SKIP_WITHOUT(path);
  const EventBatch batch = read_whole(path);
  EXPECT_EQ(batch.events.size(), GetParam().events);
  EXPECT_EQ(batch.triggers.size(), GetParam().triggers);
}

INSTANTIATE_TEST_SUITE_P(Recordings, Faults,
                         testing::Values(Fault{"truncated_odd.raw", 44440, 2}, Fault{"crlf_header.raw", 82469, 2},
                                         Fault{"minimal_old_header.raw", 82469, 2},
                                         Fault{"silky_hd_header.raw", 82469, 2}, Fault{"evt_only_header.raw", 82469, 2},
                                         Fault{"header_only.raw", 0, 0}, Fault{"time_wrap3.raw", 193, 0}),
                         [](const auto& test) { return "n" + std::to_string(test.index); });

TEST(FaultyFiles, OneLostByteCostsLessThanAMillisecond) {
  const auto path = event_file("fault/byte_dropped_mid.raw");
  E2LF_SKIP_WITHOUT(path);
  const EventBatch whole = read_whole(event_file("evt3_hd_trigger_1280x720.raw"));
  auto reader = open_recording(path).value();
  const EventBatch damaged = read_all(*reader).value();
  EXPECT_EQ(damaged.triggers, whole.triggers);
  size_t front = 0, back = 0;
  const size_t events = damaged.events.size();
  ASSERT_LE(events, whole.events.size());
  while (front < events && damaged.events[front] == whole.events[front]) ++front;
  while (back < events - front && damaged.events[events - 1 - back] == whole.events[whole.events.size() - 1 - back]) {
    ++back;
  }
  EXPECT_EQ(front + back, events) << "nothing is made up";
  EXPECT_LT(whole.events.t[whole.events.size() - back] - whole.events.t[front], 1000);
  const DecodeSummary summary = reader->summary();
  EXPECT_EQ(summary.of(Violation::kMisaligned).count, 1u);
  EXPECT_EQ(summary.num_gaps, 1u);
}

TEST(FaultyFiles, StrictPolicyNamesTheFirstViolationAndItsByte) {
  const auto path = event_file("fault/byte_dropped_mid.raw");
  E2LF_SKIP_WITHOUT(path);
  OpenOptions options = {.policy = DecodePolicy::kStrict};
  auto reader = open_recording(path, options).value();
  const auto batch = read_all(*reader);
  ASSERT_FALSE(batch);
  EXPECT_EQ(batch.error().code, ErrorCode::kFormat);
  EXPECT_NE(batch.error().location.find("byte 3003"), std::string::npos) << batch.error().text();
}

TEST(FaultyFiles, VectorOutsideTheUsualTripleIsReadWordByWord) {
  const auto path = event_file("fault/partial_vect_issue111.raw");
  E2LF_SKIP_WITHOUT(path);
  const EventBatch batch = read_whole(path);
  ASSERT_EQ(batch.events.size(), 3u);
  EXPECT_EQ(batch.events[0], (Event{0, 0, 0, 1}));
  EXPECT_EQ(batch.events[1], (Event{10, 0, 0, 1}));
  EXPECT_EQ(batch.events[2], (Event{1, 0, 0, 1044480}));
}

TEST(FaultyFiles, ClockThatWrapsGoesOn) {
  const auto path = event_file("fault/time_wrap3.raw");
  E2LF_SKIP_WITHOUT(path);
  auto reader = open_recording(path).value();
  EXPECT_EQ(read_all(*reader).value().events.t.back(), 50331653);
  EXPECT_EQ(reader->summary().time_loops, 3u);
}

TEST(FaultyFiles, WithoutHeaderOpenWhenTold) {
  const auto path = event_file("fault/no_header.raw");
  E2LF_SKIP_WITHOUT(path);
  const auto refused = open_recording(path);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kFormat);
  OpenOptions options = {.format = "evt3"};
  EXPECT_EQ(read_whole(path, options).events.size(), 82469u);
}

}  // namespace
}  // namespace e2lf::recordings
