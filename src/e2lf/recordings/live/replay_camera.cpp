// SPDX-License-Identifier: MIT
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <thread>

#include "e2lf/recordings/live/cameras.h"
#include "e2lf/recordings/live/raw_replay.h"

namespace e2lf::recordings {
namespace {

using Clock = std::chrono::steady_clock;

/// Events are delivered in intervals of this length, like the buffers of a camera.
constexpr int64_t kStretchUs = 1000;
constexpr size_t kBatchEvents = size_t{1} << 16;

class ReplayCamera final : public Camera {
 public:
  ReplayCamera(ReaderPtr reader, double speed) : reader_(std::move(reader)), speed_(speed) {}

  /// Creates the encoder, whose header is delivered first.
  Result<void> open() {
    RecordingInfo info = reader_->info();
    info.format = "evt3";
    E2LF_ASSIGN_OR_RETURN(writer_, create_recording(make_memory_sink(encoded_), "evt3", info));
    return {};
  }

  Result<void> start() override {
    begin_ = Clock::now();
    return {};
  }

  Result<bool> read(std::vector<uint8_t>& bytes) override {
    bytes = std::exchange(encoded_, {});
    if (!bytes.empty()) return true;
    E2LF_ASSIGN_OR_RETURN(const bool more, next_stretch());
    if (!more || is_stopped_) return false;
    wait_until(end_us_);
    E2LF_RETURN_IF_ERROR(writer_->write(stretch_));
    bytes = std::exchange(encoded_, {});
    return true;
  }

  void stop() override { is_stopped_ = true; }

  bool keeps_unread() const override { return true; }

  DecodeSummary left_out() const override {
    const std::lock_guard lock(mutex_);
    return left_out_;
  }

 private:
  /// Fills stretch_ with the events and triggers of the next interval that contains some.
  Result<bool> next_stretch() {
    stretch_.clear();
    if (event_ == batch_.events.size() && trigger_ == batch_.triggers.size()) {
      event_ = trigger_ = 0;
      E2LF_ASSIGN_OR_RETURN(const bool more, reader_->read(batch_, kBatchEvents));
      {
        const std::lock_guard lock(mutex_);
        left_out_ = reader_->summary();
      }
      if (!more) return false;
    }
    int64_t first_us = INT64_MAX;
    if (event_ < batch_.events.size()) first_us = batch_.events.t[event_];
    if (trigger_ < batch_.triggers.size()) first_us = std::min(first_us, batch_.triggers[trigger_].t);
    if (!has_begun_) origin_us_ = first_us;
    has_begun_ = true;
    end_us_ = first_us + kStretchUs;
    const auto& t = batch_.events.t;
    const auto end = std::lower_bound(t.begin() + static_cast<ptrdiff_t>(event_), t.end(), end_us_) - t.begin();
    stretch_.events.append(batch_.events, event_, static_cast<size_t>(end));
    event_ = static_cast<size_t>(end);
    for (; trigger_ < batch_.triggers.size() && batch_.triggers[trigger_].t < end_us_; ++trigger_) {
      stretch_.triggers.push_back(batch_.triggers[trigger_]);
    }
    return true;
  }

  /// Sleeps until a time of the recording is reached, in steps that are short enough to be stopped.
  void wait_until(int64_t t_us) const {
    constexpr auto kNap = std::chrono::milliseconds(50);
    const Clock::time_point due =
        begin_ + std::chrono::microseconds(std::llround(static_cast<double>(t_us - origin_us_) / speed_));
    while (!is_stopped_ && Clock::now() < due) std::this_thread::sleep_until(std::min(due, Clock::now() + kNap));
  }

  ReaderPtr reader_;
  double speed_;
  WriterPtr writer_;
  std::vector<uint8_t> encoded_;
  EventBatch batch_, stretch_;
  size_t event_ = 0, trigger_ = 0;  ///< first ones of batch_ that were not delivered yet
  bool has_begun_ = false;
  int64_t origin_us_ = 0, end_us_ = 0;
  Clock::time_point begin_;
  std::atomic<bool> is_stopped_ = false;
  mutable std::mutex mutex_;
  DecodeSummary left_out_;  ///< of the data that was read, which is ahead of the data that was delivered
};

}  // namespace

Result<CameraPtr> open_replay_camera(const std::string& address) {
  E2LF_ASSIGN_OR_RETURN(const ReplayAddress replayed, parse_replay_address(address));
  const std::string& path = replayed.path;
  E2LF_ASSIGN_OR_RETURN(auto source, open_file_source(path));
  E2LF_ASSIGN_OR_RETURN(const bool is_evt3, is_evt3_recording(*source));
  if (is_evt3) return make_raw_replay(std::move(source), replayed);
  if (replayed.repeat > 1) {
    return Error{ErrorCode::kUnsupported,
                 "only RAW recordings in EVT3 are replayed several times; make one with e2lf convert", path};
  }
  // The reader of the camera reports what is left out.
  E2LF_ASSIGN_OR_RETURN(auto reader, open_recording(std::filesystem::path(path), {.policy = DecodePolicy::kSkip}));
  auto replay = std::make_unique<ReplayCamera>(std::move(reader), replayed.speed);
  E2LF_RETURN_IF_ERROR(replay->open());
  return CameraPtr(std::move(replay));
}

}  // namespace e2lf::recordings
