// SPDX-License-Identifier: MIT
#include "e2lf/recordings/live/camera.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <future>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

#include "e2lf/base/progress.h"
#include "e2lf/cameras/cameras.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/cycles/synthesise.h"
#include "e2lf/files/file.h"
#include "e2lf/recordings/open/registry.h"
#include "testing/test_log.h"
#include "testing/test_streams.h"

namespace e2lf::cameras {
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

  static Result<CameraPtr> open(const std::string&) {
    was_stopped = false;
    CameraPtr camera = std::make_unique<ScriptedCamera>();
    return camera;
  }

 private:
  size_t done_ = 0;
};
std::vector<uint8_t> ScriptedCamera::script;
size_t ScriptedCamera::piece = 1;
std::atomic<bool> ScriptedCamera::was_stopped = false;

const RecordingInfo kInfo = {.width = 64, .height = 48};

TEST(Camera, ItsBytesAreReadAsTheyComeAndItIsStoppedAtTheEnd) {
  add_camera_plugin({"scripted", "for tests", ScriptedCamera::open});
  const EventBatch stream = random_stream({.events = 3000, .width = 64, .height = 48, .trigger_every = 100});
  ScriptedCamera::script = encoded(stream, "evt3", kInfo);
  ScriptedCamera::piece = 777;
  EventBatch all, batch;
  const auto begin = Clock::now();
  {
    auto reader = open_named_recording("camera://scripted/any/address").value();
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

/// Waits for something that another thread does soon.
template <typename Condition>
void wait_until(Condition is_true) {
  while (!is_true()) std::this_thread::yield();
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
  CameraPatience patience() const override { return {.reader = std::chrono::milliseconds(0)}; }

 private:
  bool keeps_unread_;
  std::atomic<bool> is_stopped_ = false;
};

TEST(Camera, AReaderThatFallsBehindIsToldOnceAndItIsCounted) {
  for (const bool keeps_unread : {true, false}) {
    const TestLog log;
    const auto source = start_camera_source(std::make_unique<FastCamera>(keeps_unread), "camera://fast").value();
    wait_until([&] { return source->left_out().live.pauses > 0; });
    for (int i = 0; i < 3; ++i) {
      const auto bytes = source->fetch(1).value();
      EXPECT_LE(bytes.size(), 2 * kMaxWaitingBytes);
      source->consume(bytes.size());
    }
    const char* const fate = keeps_unread ? "nothing is lost" : "the data of the camera are dropped";
    EXPECT_NE(log.text().find(fate), std::string::npos) << log.text();
    EXPECT_EQ(std::count(log.text().begin(), log.text().end(), '\n'), 1) << log.text();
    DecodeSummary summary = source->left_out();
    EXPECT_GT(std::exchange(summary.live.most_behind_us, kBehindUs), 0);
    EXPECT_GE(summary.live.pauses, 1u);
    EXPECT_EQ(summary.live.loses_events, !keeps_unread);
    EXPECT_EQ(summary.live.dropped_bytes > 0, !keeps_unread);
    EXPECT_NE(live_text(summary).find(keeps_unread ? "nothing is lost" : "were dropped"), std::string::npos);
  }
}

/// Delivers its bytes at once, then fails or waits.
class BrokenCamera final : public Camera {
 public:
  BrokenCamera(std::vector<uint8_t> bytes, bool fails) : bytes_(std::move(bytes)), fails_(fails) {}
  Result<void> start() override { return {}; }
  Result<bool> read(std::vector<uint8_t>& bytes) override {
    bytes = std::exchange(bytes_, {});
    if (!bytes.empty()) return true;
    if (fails_) return Error{ErrorCode::kIo, "unplugged", "camera://broken"};
    return false;
  }
  void stop() override {}

 private:
  std::vector<uint8_t> bytes_;
  bool fails_;
};

TEST(Camera, WhatCameBeforeAFailureIsReadInEveryFormatAndTheFailureIsTold) {
  const EventBatch stream = random_stream({.events = 3000, .width = 64, .height = 48});
  for (const char* const format : {"evt3", "evt2", "csv"}) {
    for (const bool fails : {true, false}) {
      std::vector<uint8_t> bytes = encoded(stream, format, kInfo);
      bytes.pop_back();  // in the middle of a word or line, which is no damage then
      const TestLog log;
      SourcePtr source = start_camera_source(std::make_unique<BrokenCamera>(bytes, fails), "camera://broken").value();
      auto reader = open_recording(std::move(source), {.width = 64, .height = 48}).value();
      const auto all = read_all(*reader);
      ASSERT_TRUE(all.ok()) << all.error().text();
      EXPECT_GE(all->events.size(), 2990u) << format;
      EXPECT_EQ(reader->summary().live.failure, fails ? "camera://broken: unplugged" : "");
      EXPECT_EQ(log.text().find("unplugged; the data before that are kept") != std::string::npos, fails) << log.text();
      EXPECT_EQ(fails ? reader->summary().num_violations() : 0, 0u) << format;
    }
  }
}

TEST(Camera, OneThatFailsBeforeItsFirstByteIsAnError) {
  const auto source =
      start_camera_source(std::make_unique<BrokenCamera>(std::vector<uint8_t>(), true), "camera://broken").value();
  const auto bytes = source->fetch(1);
  ASSERT_FALSE(bytes.ok());
  EXPECT_EQ(bytes.error().message, "unplugged");
}

/// Delivers one byte, then nothing, and returns only when the test ends.
class HungCamera final : public Camera {
 public:
  explicit HungCamera(CameraPatience patience) : patience_(patience) {}
  Result<void> start() override { return {}; }
  Result<bool> read(std::vector<uint8_t>& bytes) override {
    if (std::exchange(is_first_, false)) {
      bytes = {7};
      return true;
    }
    returns.get_future().wait();
    return false;
  }
  void stop() override {}
  CameraPatience patience() const override { return patience_; }

  static std::promise<void> returns;

 private:
  CameraPatience patience_;
  bool is_first_ = true;
};
std::promise<void> HungCamera::returns;

TEST(Camera, ADriverThatDoesNotReturnIsLeftBehindAndItsSilenceIsTold) {
  constexpr std::chrono::milliseconds kShort(1);
  const TestLog log;
  auto source =
      start_camera_source(std::make_unique<HungCamera>(CameraPatience{kShort, kShort}), "camera://hung").value();
  EXPECT_EQ(source->fetch(1).value().size(), 1u);
  source->consume(1);
  source->end_at(Clock::now() + std::chrono::milliseconds(100));
  EXPECT_TRUE(source->fetch(1).value().empty());
  EXPECT_NE(source->left_out().live.failure.find("does not return"), std::string::npos);
  EXPECT_NE(log.text().find("arrived"), std::string::npos) << log.text();
  source.reset();
  HungCamera::returns.set_value();
}

TEST(Camera, EventsBehindDroppedBytesHaveTheirOwnTimesAndRows) {
  // 100 MB at once for a reader that begins later: what does not fit into 64 MiB is dropped in the middle.
  class Flood final : public Camera {
   public:
    Flood(std::vector<uint8_t> bytes, size_t header_bytes) : bytes_(std::move(bytes)), header_bytes_(header_bytes) {}
    Result<void> start() override { return {}; }
    Result<bool> read(std::vector<uint8_t>& bytes) override {
      if (done_ == bytes_.size()) return false;
      const size_t count = done_ == 0 ? header_bytes_ : std::min<size_t>(60'000, bytes_.size() - done_);
      // The last tenth comes when there is room again.
      if (done_ > bytes_.size() / 10 * 9) wait_until([this] { return has_room.load(); });
      bytes.assign(bytes_.begin() + static_cast<ptrdiff_t>(done_),
                   bytes_.begin() + static_cast<ptrdiff_t>(done_ + count));
      done_ += count;
      return true;
    }
    void stop() override { has_room = true; }

    std::atomic<bool> has_room = false;

   private:
    std::vector<uint8_t> bytes_;
    size_t header_bytes_;
    size_t done_ = 0;
  };
  // Each event tells its time by its place.
  EventBatch batch;
  std::vector<uint8_t> bytes;
  auto writer = create_recording(make_memory_sink(bytes), "evt3", kInfo).value();
  const size_t header_bytes = bytes.size();
  const auto x_of = [](int64_t t) { return static_cast<uint16_t>(t % 64); };
  const auto y_of = [](int64_t t) { return static_cast<uint16_t>(t / 64 % 48); };
  for (int64_t t = 0; bytes.size() < 100'000'000; ++t) {
    batch.events.push_back({x_of(t), y_of(t), 1, t});
    if (batch.events.size() < 100'000) continue;
    ASSERT_TRUE(writer->write(batch).ok());
    batch.clear();
  }
  const TestLog log;
  auto flood = std::make_unique<Flood>(bytes, header_bytes);
  std::atomic<bool>& has_room = flood->has_room;
  auto source = start_camera_source(std::move(flood), "camera://flood").value();
  wait_until([&] { return source->left_out().live.dropped_bytes > 10'000'000; });
  auto reader = open_recording(SourcePtr(std::move(source))).value();
  uint64_t count = 0;
  int64_t last_us = -1;
  while (reader->read(batch).value()) {
    has_room = true;
    for (size_t i = 0; i < batch.events.size(); ++i) {
      const Event event = batch.events[i];
      ASSERT_GT(event.t, last_us);
      ASSERT_EQ(event.x, x_of(event.t));
      ASSERT_EQ(event.y, y_of(event.t));
      last_us = event.t;
    }
    count += batch.events.size();
  }
  const DecodeSummary summary = reader->summary();
  EXPECT_GT(summary.live.dropped_bytes, 10'000'000u);
  EXPECT_EQ(summary.live.pauses, 1u);
  EXPECT_EQ(summary.of(Violation::kMisaligned).count, 1u);
  ASSERT_GE(summary.num_gaps, 1u);
  EXPECT_GT(summary.gaps[0].end_us - summary.gaps[0].begin_us, 1'000'000);
  EXPECT_GT(count, 1'000'000u);
}

TEST(Camera, TheEndThatIsAskedForComesThoughNothingArrives) {
  add_camera_plugin({"scripted", "for tests", ScriptedCamera::open});
  ScriptedCamera::script = {'x'};
  ScriptedCamera::piece = 1;
  auto source = open_live_bytes("camera://scripted").value();
  const auto begin = Clock::now();
  source->end_at(begin + std::chrono::milliseconds(20));
  EXPECT_EQ(source->fetch(2).value().size(), 1u);
  source->consume(1);
  EXPECT_TRUE(source->fetch(1).value().empty());
  EXPECT_GE(Clock::now() - begin, std::chrono::milliseconds(20));
}

TEST(Camera, SettingsOfACameraAreRefusedWhereThereAreNone) {
  add_camera_plugin({"scripted", "for tests", ScriptedCamera::open});
  const auto reader = open_named_recording("camera://scripted", {.camera = {.trigger_channels = {"main"}}});
  ASSERT_FALSE(reader.ok());
  EXPECT_EQ(reader.error().code, ErrorCode::kUnsupported);
}

TEST(Camera, NamesThatAreNoneSayWhatThereIs) {
  const auto unknown = open_named_recording("camera://nosuch");
  ASSERT_FALSE(unknown.ok());
  EXPECT_EQ(unknown.error().code, ErrorCode::kNotFound);
  EXPECT_NE(unknown.error().message.find("replay"), std::string::npos);
  EXPECT_EQ(open_live_bytes("recording.raw").error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(open_named_recording("replay:/nowhere.raw").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(open_named_recording("camera://pipe/7").error().code, ErrorCode::kNotFound);
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

TEST(PipeCamera, AStopLosesNothingThatHadCome) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const std::vector<uint8_t> script(60'000, 7);
  ASSERT_EQ(::write(ends[1], script.data(), script.size()), 60'000);
  auto camera = open_pipe_camera("/proc/self/fd/" + std::to_string(ends[0])).value();
  camera->stop();
  std::vector<uint8_t> all, bytes;
  while (camera->read(bytes).value()) {
    all.insert(all.end(), bytes.begin(), bytes.end());
    // A sender that goes on does not keep it from ending.
    ASSERT_EQ(::write(ends[1], script.data(), 5000), 5000);
    ASSERT_LE(all.size(), script.size());
  }
  EXPECT_EQ(all, script);
  ::close(ends[0]);
  ::close(ends[1]);
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
EventBatch write_cycles(const std::filesystem::path& path, uint64_t cycles, const cycles::SynthesisOptions& synthesis,
                        const std::string& format = "hdf5") {
  EventBatch all;
  for (uint64_t number = 0; number < cycles; ++number) {
    capture::EventImages images(synthesis.schedule.num_images(), 48, 64);
    for (int16_t& count : images.values) count = 2;
    const cycles::SynthesisedCycle cycle = synthesise_cycle(images, number, synthesis);
    all.append(cycle.batch);
  }
  write_recording(path, all, kInfo, format);
  return all;
}

TEST(ReplayCamera, GivesTheSameEventsAtRecordedSpeed) {
  const TestFolder folder;
  cycles::SynthesisOptions synthesis;
  synthesis.schedule = cycles::plain_schedule(4, 10000);
  const EventBatch all = write_cycles(folder / "a.hdf5", 3, synthesis);
  const auto begin = Clock::now();
  auto reader = open_named_recording("replay:" + (folder / "a.hdf5").string()).value();
  EventBatch played = read_all(*reader).value();
  const auto duration_us = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - begin).count();
  EXPECT_EQ(played.events, all.events);
  EXPECT_EQ(played.triggers, all.triggers);
  EXPECT_GE(duration_us, all.events.t.back() - all.events.t.front());
}

TEST(ReplayCamera, DeliversARawRecordingByteForByteAtRecordedSpeed) {
  const TestFolder folder;
  cycles::SynthesisOptions synthesis;
  synthesis.schedule = cycles::plain_schedule(4, 10000);
  const EventBatch all = write_cycles(folder / "a.raw", 3, synthesis, "evt3");
  auto camera = open_replay_camera(folder / "a.raw").value();
  const auto begin = Clock::now();
  ASSERT_TRUE(camera->start());
  std::vector<uint8_t> bytes, delivered;
  size_t reads = 0;
  for (; camera->read(bytes).value(); ++reads) delivered.insert(delivered.end(), bytes.begin(), bytes.end());
  const auto duration_us = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - begin).count();
  EXPECT_EQ(delivered, read_file(folder / "a.raw").value());
  EXPECT_GE(duration_us, all.events.t.back() - all.events.t.front() - 5000);
  EXPECT_GT(reads, 20U);
  auto reader = open_named_recording("replay:" + (folder / "a.raw").string()).value();
  EXPECT_EQ(read_all(*reader).value().events, all.events);
}

TEST(ReplayCamera, GoesOnInTimeWhenItIsRepeatedAndAtAnotherSpeed) {
  const TestFolder folder;
  cycles::SynthesisOptions synthesis;
  synthesis.schedule = cycles::plain_schedule(4, 10000);
  const EventBatch all = write_cycles(folder / "a.raw", 1, synthesis, "evt3");
  const auto begin = Clock::now();
  // More often than the 4096 steps of TIME_HIGH go.
  constexpr size_t kRepeats = 600;
  auto reader = open_named_recording("replay:" + (folder / "a.raw").string() + "?repeat=600&speed=500").value();
  const EventBatch played = read_all(*reader).value();
  const auto duration_us = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - begin).count();
  EXPECT_TRUE(reader->summary().restarts.empty());
  ASSERT_EQ(played.events.size(), kRepeats * all.events.size());
  ASSERT_EQ(played.triggers.size(), kRepeats * all.triggers.size());
  const size_t once = all.events.size();
  const int64_t period_us = played.events.t[once] - played.events.t[0];
  const int64_t length_us = all.events.t.back() - all.events.t.front();
  EXPECT_GT(period_us, length_us);
  EXPECT_LT(period_us, length_us + 3 * 4096);
  for (size_t i = 0; i < played.events.size(); ++i) {
    const auto repeat = static_cast<int64_t>(i / once);
    ASSERT_EQ(played.events.t[i] - repeat * period_us, all.events.t[i % once]);
    ASSERT_EQ(played.events.x[i], all.events.x[i % once]);
  }
  EXPECT_GE(duration_us, length_us * static_cast<int64_t>(kRepeats) / 500);
  EXPECT_EQ(replay_speed("replay:" + (folder / "a.raw").string() + "?repeat=600&speed=0.25"), 0.25);
  EXPECT_EQ(replay_speed("camera://replay/a.raw?speed=4"), 4);
  EXPECT_EQ(replay_speed("tcp:99?speed=4"), 1);
  for (const char* wrong : {"?speed=0", "?repeat=0", "?repeat=x", "?faster=2", "?speed=nan"}) {
    EXPECT_EQ(open_named_recording("replay:" + (folder / "a.raw").string() + wrong).error().code,
              ErrorCode::kInvalidValue);
  }
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
      cycles::CycleReader::open(open_named_recording("replay:" + (folder / "a.hdf5").string()).value(), options)
          .value();
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
}  // namespace e2lf::cameras
