// SPDX-License-Identifier: MIT
#include "e2lf/recordings/live/camera.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <future>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <thread>

#include "e2lf/base/stop.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/cycles/synthesise.h"
#include "e2lf/files/file.h"
#include "e2lf/recordings/live/camera_source.h"
#include "e2lf/recordings/live/cameras.h"
#include "testing/test_log.h"
#include "testing/test_streams.h"

namespace e2lf::recordings {
namespace {

using Clock = std::chrono::steady_clock;

/// Delivers the bytes it was given piece by piece, then waits until it is stopped, as a camera without events does.
class ScriptedCamera final : public Camera {
 public:
  static std::vector<uint8_t> script;
  static size_t piece;
  static std::atomic<bool> was_stopped;

  Result<void> start() override { return {}; }
  Result<bool> read(std::vector<uint8_t>& bytes) override {
    const size_t count = std::min(piece, script.size() - done_);
    if (count == 0) {
      while (!was_stopped) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return false;
    }
    bytes.assign(script.begin() + static_cast<ptrdiff_t>(done_),
                 script.begin() + static_cast<ptrdiff_t>(done_ + count));
    done_ += count;
    return true;
  }
  void stop() override { was_stopped = true; }

  static Result<std::unique_ptr<Camera>> open(const std::string&) {
    was_stopped = false;
    std::unique_ptr<Camera> camera = std::make_unique<ScriptedCamera>();
    return camera;
  }

 private:
  size_t done_ = 0;
};
std::vector<uint8_t> ScriptedCamera::script;
size_t ScriptedCamera::piece = 1;
std::atomic<bool> ScriptedCamera::was_stopped = false;

const RecordingInfo kInfo = {.format = "evt3", .width = 64, .height = 48, .header = {}};

std::vector<uint8_t> encode(const EventBatch& batch) {
  std::vector<uint8_t> bytes;
  auto writer = create_recording(make_memory_sink(bytes), "evt3", kInfo).value();
  EXPECT_TRUE(writer->write(batch).ok());
  return bytes;
}

TEST(Camera, ItsBytesAreReadAsTheyComeAndItIsStoppedAtTheEnd) {
  add_camera_plugin({"scripted", "for tests", ScriptedCamera::open});
  const EventBatch stream = random_stream({.events = 3000, .width = 64, .height = 48, .trigger_every = 100});
  ScriptedCamera::script = encode(stream);
  ScriptedCamera::piece = 777;
  EventBatch all, batch;
  const auto begin = Clock::now();
  {
    auto reader = open_camera("camera://scripted/any/address").value();
    EXPECT_EQ(reader->info().width, 64u);
    // The last words wait for their successors, as damage shows only then.
    while (all.events.size() < 2900) {
      ASSERT_TRUE(reader->read(batch).value());
      ASSERT_TRUE(reader->arrival().has_value());
      EXPECT_GE(*reader->arrival(), begin);
      EXPECT_LE(*reader->arrival(), Clock::now());
      all.events.append(batch.events);
    }
  }
  EXPECT_TRUE(ScriptedCamera::was_stopped);
  for (size_t i = 0; i < all.events.size(); ++i) ASSERT_EQ(all.events[i], stream.events[i]);
}

/// Delivers zeros without end, a MiB at a time.
class FastCamera final : public Camera {
 public:
  explicit FastCamera(bool keeps_unread) : keeps_unread_(keeps_unread) {}
  Result<void> start() override { return {}; }
  Result<bool> read(std::vector<uint8_t>& bytes) override {
    bytes.assign(size_t{1} << 20, 0);
    return !is_stopped_;
  }
  void stop() override { is_stopped_ = true; }
  bool keeps_unread() const override { return keeps_unread_; }

 private:
  bool keeps_unread_;
  std::atomic<bool> is_stopped_ = false;
};

TEST(Camera, AReaderThatFallsBehindIsToldOnceAndItIsCounted) {
  for (const bool keeps_unread : {true, false}) {
    const TestLog log;
    const auto source = start_camera_source(std::make_unique<FastCamera>(keeps_unread), "camera://fast").value();
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    for (int i = 0; i < 3; ++i) {
      const auto bytes = source->fetch(1).value();
      EXPECT_LE(bytes.size(), 2 * kMaxWaitingBytes);
      source->consume(bytes.size());
    }
    const char* const fate = keeps_unread ? "nothing is lost" : "its driver loses what it cannot buffer";
    EXPECT_NE(log.text().find(fate), std::string::npos) << log.text();
    EXPECT_EQ(std::count(log.text().begin(), log.text().end(), '\n'), 1) << log.text();
    const DecodeSummary summary = source->left_out();
    EXPECT_GE(summary.live.most_behind_us, 1'000'000);
    EXPECT_GE(summary.live.pauses, 1u);
    EXPECT_EQ(summary.live.loses_events, !keeps_unread);
    EXPECT_NE(live_text(summary).find(keeps_unread ? "nothing is lost" : "may have lost"), std::string::npos);
  }
}

TEST(Camera, NamesThatAreNoneSayWhatThereIs) {
  const auto unknown = open_camera("camera://nosuch");
  ASSERT_FALSE(unknown.ok());
  EXPECT_EQ(unknown.error().code, ErrorCode::kNotFound);
  EXPECT_NE(unknown.error().message.find("replay"), std::string::npos);
  EXPECT_EQ(open_camera("recording.raw").error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(open_camera("replay:/nowhere.raw").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(open_camera("camera://pipe/7").error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(is_camera_name("tcp://127.0.0.1:9") && is_camera_name("replay:x") && !is_camera_name("x.raw"));
}

TEST(PipeCamera, AStopThatCameBeforeTheFirstByteIsSeen) {
  const TestFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  request_stop(SIGTERM);
  const auto stopped = open_pipe_camera(folder / "pipe");
  request_stop(0);
  ASSERT_FALSE(stopped.ok());
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
}

TEST(PipeCamera, GivesWhatIsWrittenUntilTheWriterLeaves) {
  const TestFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const std::vector<uint8_t> script(300'000, 9);
  auto writer = std::async(std::launch::async, [&] { return write_file(folder / "pipe", script).ok(); });
  auto camera = open_pipe_camera(folder / "pipe").value();
  std::vector<uint8_t> all, bytes;
  while (camera->read(bytes).value()) all.insert(all.end(), bytes.begin(), bytes.end());
  EXPECT_EQ(all, script);
  EXPECT_TRUE(writer.get());
}

/// A recording of `cycles` pattern cycles in `path`; its events.
EventBatch write_cycles(const std::filesystem::path& path, uint64_t cycles, const cycles::SynthesisOptions& synthesis) {
  EventBatch all;
  for (uint64_t number = 0; number < cycles; ++number) {
    capture::EventImages images(synthesis.schedule.num_images(), 48, 64);
    for (int16_t& count : images.counts) count = 2;
    const cycles::SynthesisedCycle cycle = synthesise_cycle(images, number, synthesis);
    all.events.append(cycle.batch.events);
    all.triggers.insert(all.triggers.end(), cycle.batch.triggers.begin(), cycle.batch.triggers.end());
  }
  auto writer = create_recording(path, "hdf5", kInfo).value();
  EXPECT_TRUE(writer->write(all).ok() && writer->finish().ok());
  return all;
}

TEST(ReplayCamera, GivesTheSameEventsAtRecordedSpeed) {
  const TestFolder folder;
  cycles::SynthesisOptions synthesis;
  synthesis.schedule = cycles::plain_schedule(4, 10000);
  const EventBatch all = write_cycles(folder / "a.hdf5", 3, synthesis);
  const auto begin = Clock::now();
  auto reader = open_camera("replay:" + (folder / "a.hdf5").string()).value();
  EventBatch played = read_all(*reader).value();
  const auto duration_us = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - begin).count();
  EXPECT_EQ(played.events, all.events);
  EXPECT_EQ(played.triggers, all.triggers);
  EXPECT_GE(duration_us, all.events.t.back() - all.events.t.front());
}

TEST(ReplayCamera, CyclesCarryTheirArrival) {
  const TestFolder folder;
  cycles::SynthesisOptions synthesis;
  synthesis.schedule = cycles::plain_schedule(4, 10000);
  write_cycles(folder / "a.hdf5", 3, synthesis);
  cycles::CycleOptions options;
  options.source = cycles::CycleSource::kTriggers;
  options.schedule = synthesis.schedule;
  options.tracker.first_pattern = 0;
  const auto begin = Clock::now();
  auto cycles =
      cycles::CycleReader::open(open_camera("replay:" + (folder / "a.hdf5").string()).value(), options).value();
  for (int i = 0; i < 3; ++i) {
    const auto cycle = cycles.next().value();
    ASSERT_TRUE(cycle.has_value());
    ASSERT_TRUE(cycle->arrival.has_value());
    EXPECT_GE(*cycle->arrival, begin);
    EXPECT_LE(*cycle->arrival, Clock::now());
    // The last pattern of a recording ends when it is expected to.
    if (i == 2) break;
    EXPECT_GE(cycle->known_us, cycle->slices.back().end_us);
  }
}

}  // namespace
}  // namespace e2lf::recordings
