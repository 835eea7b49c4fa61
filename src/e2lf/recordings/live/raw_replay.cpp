// SPDX-License-Identifier: MIT
#include "e2lf/recordings/live/raw_replay.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "e2lf/base/little_endian.h"
#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_skip.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_header.h"

namespace e2lf::recordings {
namespace {

using Clock = std::chrono::steady_clock;

/// Words are delivered in intervals of at least this length, like the buffers of a camera, or up to the next TIME_HIGH.
constexpr int64_t kLeastStretchUs = 1000;
constexpr size_t kSearchedWords = 2048, kMostStretchWords = size_t{1} << 20;
/// Largest step of TIME_HIGH that takes time; longer ones are skipped.
constexpr uint32_t kMostSteps = 64;

class RawReplay final : public Camera {
 public:
  explicit RawReplay(std::unique_ptr<ByteSource> source) : source_(std::move(source)) {}

  Result<void> start() override {
    begin_ = Clock::now();
    return {};
  }

  Result<bool> read(std::vector<uint8_t>& bytes) override {
    if (is_stopped_) return false;
    if (std::exchange(is_header_, false)) return read_header(bytes);
    E2LF_ASSIGN_OR_RETURN(const std::span<const uint8_t> ahead, source_->fetch(2 * kMostStretchWords));
    if (ahead.empty()) return false;
    const size_t words = find_stretch(ahead.data(), ahead.size() / 2);
    const size_t end = words == 0 || 2 * words + 1 == ahead.size() ? ahead.size() : 2 * words;
    wait_until(time_us());
    bytes.assign(ahead.begin(), ahead.begin() + static_cast<ptrdiff_t>(end));
    source_->consume(end);
    return !is_stopped_;
  }

  void stop() override { is_stopped_ = true; }
  bool keeps_unread() const override { return true; }

 private:
  Result<bool> read_header(std::vector<uint8_t>& bytes) {
    E2LF_ASSIGN_OR_RETURN(const std::span<const uint8_t> head, source_->fetch(kDetectBytes));
    E2LF_ASSIGN_OR_RETURN(const RawHeader header, parse_raw_header(head, true, source_->name()));
    bytes.assign(head.begin(), head.begin() + static_cast<ptrdiff_t>(header.num_bytes));
    source_->consume(header.num_bytes);
    return true;
  }

  /// Advances to the end of the next interval and returns its number of words.
  size_t find_stretch(const uint8_t* words, size_t count) {
    const int64_t begin_us = time_us();
    size_t end = 0;
    while (end < std::min(count, kMostStretchWords) && time_us() < begin_us + kLeastStretchUs) {
      const size_t block = std::min(kSearchedWords, count - end);
      const size_t mark = evt3::find_mark(words + 2 * end, block, time_high_);
      if (const size_t low = evt3::find_last(words + 2 * end, mark, evt3::only(evt3::kTimeLow)); low < mark) {
        low_us_ = load_le<uint16_t>(words + 2 * (end + low)) & evt3::kPayloadMask;
      }
      end += mark;
      if (mark == block) continue;
      const auto word = load_le<uint16_t>(words + 2 * end++);
      if (word >> 12 == evt3::kTimeHigh) take_time_high(word);
    }
    return end;
  }

  void take_time_high(uint16_t word) {
    const uint32_t step = (static_cast<uint32_t>(word) - time_high_) & evt3::kPayloadMask;
    if (time_high_ != kUnknown && step <= kMostSteps) high_us_ += int64_t{step} << 12;
    time_high_ = word;
    low_us_ = 0;
  }

  /// Returns the time of the last word relative to the first TIME_HIGH word.
  [[nodiscard]] int64_t time_us() const { return high_us_ + low_us_; }

  /// Sleeps in steps that are short enough to be stopped.
  void wait_until(int64_t t_us) const {
    constexpr auto kNap = std::chrono::milliseconds(50);
    const Clock::time_point due = begin_ + std::chrono::microseconds(t_us);
    while (!is_stopped_ && Clock::now() < due) std::this_thread::sleep_until(std::min(due, Clock::now() + kNap));
  }

  static constexpr uint16_t kUnknown = 0xFFFF;

  std::unique_ptr<ByteSource> source_;
  bool is_header_ = true;  ///< whether the header is delivered next
  uint16_t time_high_ = kUnknown;
  int64_t high_us_ = 0, low_us_ = 0;
  Clock::time_point begin_;
  std::atomic<bool> is_stopped_ = false;
};

}  // namespace

Result<bool> is_evt3_recording(ByteSource& source) {
  E2LF_ASSIGN_OR_RETURN(const std::span<const uint8_t> head, source.fetch(kDetectBytes));
  if (!is_raw_header(head)) return false;
  const auto header = parse_raw_header(head, true, source.name());
  return header && header->info.format == "evt3";
}

std::unique_ptr<Camera> make_raw_replay(std::unique_ptr<ByteSource> source) {
  return std::make_unique<RawReplay>(std::move(source));
}

}  // namespace e2lf::recordings
