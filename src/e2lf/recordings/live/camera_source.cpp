// SPDX-License-Identifier: MIT
// Makes a camera a source of bytes; declared in cameras.h.
#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

#include "e2lf/base/contract.h"
#include "e2lf/base/log.h"
#include "e2lf/base/stop.h"
#include "e2lf/base/text.h"
#include "e2lf/recordings/live/cameras.h"

namespace e2lf::recordings {
namespace {

using Clock = std::chrono::steady_clock;

class CameraSource final : public LiveSource {
 public:
  CameraSource(CameraPtr camera, std::string name)
      : camera_(std::move(camera)), name_(std::move(name)), thread_([this] { take_bytes(); }) {}
  CameraSource(const CameraSource&) = delete;
  CameraSource& operator=(const CameraSource&) = delete;
  ~CameraSource() override {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      is_discarding_ = true;
    }
    camera_->stop();
    changed_.notify_all();
    thread_.join();
  }

  Result<std::span<const uint8_t>> fetch(size_t wanted) override {
    std::unique_lock<std::mutex> lock(mutex_);
    for (;;) {
      if (!is_stopping_ && (stop_requested() || Clock::now() >= end_)) stop_camera(lock);
      if (buffer_.size() - begin_ >= wanted) break;
      if (!waiting_.empty()) {
        if (waiting_.front().gap && position_ + buffer_.size() == 0) take_gap();  // nothing is cut there
        if (waiting_.front().gap) break;
        append_waiting();
      } else if (has_ended_) {
        if (position_ == 0 && buffer_.empty() && error_) return *error_;
        if (error_) backlog_.failure = error_->text();
        break;
      } else {
        changed_.wait_for(lock, kNap);  // a signal does not notify this condition variable
      }
    }
    const bool has_failed = !backlog_.failure.empty() && !std::exchange(is_failure_told_, true);
    const bool is_behind = (backlog_.most_behind_us >= kBehindUs || backlog_.loses_events) && !is_behind_told_;
    const bool has_lost = backlog_.lost_buffers > 0 && !std::exchange(is_loss_told_, true);
    is_behind_told_ = is_behind_told_ || is_behind;
    const std::string behind = is_behind ? behind_text() : "";
    lock.unlock();  // the recipient of the message may block
    if (is_behind) camera_->keeps_unread() ? log_info(behind) : log_warning(behind);
    if (has_lost)
      log_warning(cat(name_, ": the camera or its driver loses data; check the cable and the load of the computer"));
    if (has_failed) log_warning(cat(error_->text(), "; the data before that are kept"));
    return std::span<const uint8_t>(buffer_).subspan(begin_);
  }
  void consume(size_t count) override {
    E2LF_REQUIRE(count <= buffer_.size() - begin_, "more consumed than fetched");
    begin_ += count;
    position_ += count;
  }
  uint64_t position() const override { return position_; }
  Result<void> seek(uint64_t) override {
    return Error{ErrorCode::kUnsupported, "a live source is not seekable; record it to a file first", name_};
  }
  bool seekable() const override { return false; }
  std::optional<uint64_t> size() const override { return std::nullopt; }
  std::string name() const override { return name_; }
  DecodeSummary left_out() const override {
    DecodeSummary all = camera_->left_out();
    const std::lock_guard<std::mutex> lock(mutex_);
    all.live = backlog_;
    return all;
  }
  std::optional<Clock::time_point> arrival() const override { return arrival_; }
  bool pass_break() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (waiting_.empty() || !waiting_.front().gap) return false;
    consume(buffer_.size() - begin_);
    take_gap();
    return true;
  }
  void end_at(Clock::time_point time) override { end_ = time; }
  std::string bias_file_text() const override { return camera_->bias_file_text(); }

 private:
  static constexpr auto kNap = std::chrono::milliseconds(50);

  struct Chunk {
    std::vector<uint8_t> bytes;
    Clock::time_point arrival;
    std::optional<LiveGap> gap = {};  ///< data missing before it
  };

  /// Requests the end of the camera. Bytes that have arrived by then are still returned.
  void stop_camera(std::unique_lock<std::mutex>& lock) {
    is_stopping_ = true;
    lock.unlock();
    camera_->stop();
    lock.lock();
  }

  /// Moves the bytes that the camera delivers to waiting_. Runs in the thread.
  void take_bytes() {
    std::vector<uint8_t> bytes;
    for (bool more = true; more;) {
      const Result<bool> delivered = camera_->read(bytes);
      const Clock::time_point now = Clock::now();
      std::unique_lock<std::mutex> lock(mutex_);
      if (!delivered) error_ = delivered.error();
      more = delivered && *delivered && !is_discarding_;
      if (more) note_lost(camera_->lost_buffers());
      if (more && !bytes.empty() && make_room(lock, bytes.size())) {
        waiting_bytes_ += bytes.size();
        waiting_.push_back({std::move(bytes), now, std::exchange(missing_, std::nullopt)});
        bytes = {};
      }
      if (!more && missing_) waiting_.push_back({{}, now, missing_});
      has_ended_ = !more;
      changed_.notify_all();
    }
  }

  void take_gap() {
    std::optional<LiveGap>& gap = waiting_.front().gap;
    gap->byte = position_;
    backlog_.add_gap(*gap);
    gap.reset();
  }

  void note_lost(uint64_t buffers) {
    if (buffers == 0) return;
    backlog_.lost_buffers += buffers;
    if (!missing_) missing_.emplace();
    missing_->lost_buffers += buffers;
  }

  /// Returns true if there is room for bytes that have arrived. A sender waits for room; without it, bytes of a camera
  /// are dropped.
  bool make_room(std::unique_lock<std::mutex>& lock, size_t bytes) {
    if (waiting_bytes_ < kMaxWaitingBytes) return true;
    if (camera_->keeps_unread()) {
      ++backlog_.pauses;
      changed_.wait(lock, [this] { return waiting_bytes_ < kMaxWaitingBytes || is_discarding_; });
      return true;
    }
    if (!missing_) missing_.emplace();
    if (missing_->dropped_bytes == 0) ++backlog_.pauses;
    missing_->dropped_bytes += bytes;
    backlog_.loses_events = true;
    backlog_.dropped_bytes += bytes;
    return false;
  }

  /// Appends the waiting bytes, up to a place where bytes are missing, to the rest of the buffer.
  void append_waiting() {
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<ptrdiff_t>(begin_));
    begin_ = 0;
    const auto behind = Clock::now() - waiting_.front().arrival;
    backlog_.most_behind_us = std::max<int64_t>(backlog_.most_behind_us,
                                                std::chrono::duration_cast<std::chrono::microseconds>(behind).count());
    while (!waiting_.empty() && !waiting_.front().gap) {
      const Chunk& chunk = waiting_.front();
      buffer_.insert(buffer_.end(), chunk.bytes.begin(), chunk.bytes.end());
      arrival_ = chunk.arrival;
      waiting_bytes_ -= chunk.bytes.size();
      waiting_.pop_front();
    }
    changed_.notify_all();
  }

  /// Returns the message that is logged once if the reader is too slow.
  std::string behind_text() const {
    return cat(name_, ": the input arrives faster than it is processed: the data that are read now arrived ",
               static_cast<double>(backlog_.most_behind_us / 100'000) * 0.1, " s ago. Up to ", kMaxWaitingBytes >> 20U,
               " MiB wait in memory; above that, ",
               camera_->keeps_unread() ? "the sender waits, and nothing is lost" : "the data of the camera are dropped",
               ". Record the input to a file and process that, or choose a faster method");
  }

  CameraPtr camera_;
  std::string name_;

  // Used only by the reader.
  bool is_behind_told_ = false, is_loss_told_ = false, is_failure_told_ = false, is_stopping_ = false;
  Clock::time_point end_ = Clock::time_point::max();
  std::vector<uint8_t> buffer_;
  size_t begin_ = 0;
  uint64_t position_ = 0;
  std::optional<Clock::time_point> arrival_;  ///< arrival of the last bytes of the buffer

  // Shared with the thread.
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Chunk> waiting_;
  size_t waiting_bytes_ = 0;
  bool has_ended_ = false;
  bool is_discarding_ = false;      ///< whether the reader has gone
  std::optional<LiveGap> missing_;  ///< data missing before the next bytes
  LiveBacklog backlog_;
  std::optional<Error> error_;

  std::thread thread_;  ///< last, because it uses the members above
};

}  // namespace

Result<std::unique_ptr<LiveSource>> start_camera_source(CameraPtr camera, std::string name, const CameraSetup& setup) {
  E2LF_RETURN_IF_ERROR(camera->set_up(setup));
  E2LF_RETURN_IF_ERROR(camera->start());
  return std::unique_ptr<LiveSource>(std::make_unique<CameraSource>(std::move(camera), std::move(name)));
}

}  // namespace e2lf::recordings
