// SPDX-License-Identifier: MIT
#include "e2lf/recordings/live/camera_source.h"

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

namespace e2lf::recordings {
namespace {

using Clock = std::chrono::steady_clock;

class CameraSource final : public ByteSource {
 public:
  CameraSource(std::unique_ptr<Camera> camera, std::string name)
      : camera_(std::move(camera)), name_(std::move(name)), thread_([this] { take_bytes(); }) {}
  CameraSource(const CameraSource&) = delete;
  CameraSource& operator=(const CameraSource&) = delete;
  ~CameraSource() override {
    camera_->stop();
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      is_stopped_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }

  Result<std::span<const uint8_t>> fetch(size_t wanted) override {
    std::unique_lock<std::mutex> lock(mutex_);
    while (buffer_.size() - begin_ < wanted) {
      // A signal does not wake this thread.
      while (waiting_.empty() && !has_ended_ && !stop_requested()) changed_.wait_for(lock, kNap);
      if (stop_requested() && !is_stopped_) {
        is_stopped_ = true;  // reads no more than what has arrived
        lock.unlock();
        camera_->stop();
        changed_.notify_all();
        lock.lock();
      }
      if (waiting_.empty()) break;
      append_waiting();
    }
    if (buffer_.size() == begin_ && error_) return *error_;
    const bool is_behind = backlog_.most_behind_us >= kBehindUs || backlog_.loses_events;
    if (is_behind && !std::exchange(is_told_, true)) {
      const std::string text = behind_text();
      lock.unlock();  // the receiver of the message may wait for others
      camera_->keeps_unread() ? log_info(text) : log_warning(text);
    }
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

 private:
  static constexpr auto kNap = std::chrono::milliseconds(50);

  struct Chunk {
    std::vector<uint8_t> bytes;
    Clock::time_point arrival;
  };

  /// The thread function: moves what the camera delivers to waiting_.
  void take_bytes() {
    std::vector<uint8_t> bytes;
    for (;;) {
      const Result<bool> more = camera_->read(bytes);
      const Clock::time_point now = Clock::now();
      std::unique_lock<std::mutex> lock(mutex_);
      if (!more) error_ = more.error();
      has_ended_ = !more || !*more || is_stopped_;
      if (has_ended_) break;
      if (bytes.empty()) continue;
      if (waiting_bytes_ >= kMaxWaitingBytes) {
        ++backlog_.pauses;
        backlog_.loses_events = !camera_->keeps_unread();
      }
      changed_.wait(lock, [this] { return waiting_bytes_ < kMaxWaitingBytes || is_stopped_; });
      waiting_bytes_ += bytes.size();
      waiting_.push_back({std::move(bytes), now});
      bytes = {};
      changed_.notify_all();
    }
    changed_.notify_all();
  }

  /// Appends everything that is waiting to the rest of the buffer.
  void append_waiting() {
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<ptrdiff_t>(begin_));
    begin_ = 0;
    for (const Chunk& chunk : waiting_) buffer_.insert(buffer_.end(), chunk.bytes.begin(), chunk.bytes.end());
    const auto behind = Clock::now() - waiting_.front().arrival;
    backlog_.most_behind_us = std::max<int64_t>(backlog_.most_behind_us,
                                                std::chrono::duration_cast<std::chrono::microseconds>(behind).count());
    arrival_ = waiting_.back().arrival;
    waiting_.clear();
    waiting_bytes_ = 0;
    changed_.notify_all();
  }

  /// Returns the message that is logged once if the reader is too slow.
  std::string behind_text() const {
    return cat(name_, ": the input arrives faster than it is processed: what is read now arrived ",
               static_cast<double>(backlog_.most_behind_us / 100'000) * 0.1, " s ago. Up to ", kMaxWaitingBytes >> 20U,
               " MiB wait in memory; beyond that ",
               camera_->keeps_unread() ? "the sender waits, and nothing is lost"
                                       : "the camera is not read, and its driver loses what it cannot buffer",
               ". Record the input to a file and process that, or choose a faster method");
  }

  std::unique_ptr<Camera> camera_;
  std::string name_;

  // Used only by the reader.
  bool is_told_ = false;
  std::vector<uint8_t> buffer_;
  size_t begin_ = 0;
  uint64_t position_ = 0;
  std::optional<Clock::time_point> arrival_;  ///< of the last bytes of the buffer

  // Shared with the thread.
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Chunk> waiting_;
  size_t waiting_bytes_ = 0;
  bool has_ended_ = false, is_stopped_ = false;
  LiveBacklog backlog_;
  std::optional<Error> error_;

  std::thread thread_;  ///< last: it uses all of the above
};

}  // namespace

Result<std::unique_ptr<ByteSource>> start_camera_source(std::unique_ptr<Camera> camera, std::string name) {
  E2LF_RETURN_IF_ERROR(camera->start());
  std::unique_ptr<ByteSource> source = std::make_unique<CameraSource>(std::move(camera), std::move(name));
  return source;
}

}  // namespace e2lf::recordings
