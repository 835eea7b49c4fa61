// SPDX-License-Identifier: MIT
#include "e2lf/recordings/live/raw_replay.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "e2lf/base/little_endian.h"
#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_skip.h"
#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_header.h"

namespace e2lf::recordings {
namespace {

using Clock = std::chrono::steady_clock;

/// Words are delivered in intervals of at least this length, like the buffers of a camera, or up to the next TIME_HIGH,
/// or as many as there are. If more bytes were requested, they would be moved again and again in the buffer of a file.
constexpr int64_t kLeastStretchUs = 1000;
constexpr size_t kWantedBytes = size_t{1} << 17;
constexpr size_t kSearchedWords = 2048, kMostStretchWords = size_t{1} << 20;
/// Largest step of TIME_HIGH that takes time; longer ones are skipped.
constexpr uint32_t kMostSteps = 64;

class RawReplay final : public Camera {
 public:
  RawReplay(SourcePtr source, const ReplayAddress& replay)
      : source_(std::move(source)), speed_(replay.speed), repeats_(replay.repeat - 1) {}

  Result<void> start() override {
    begin_ = Clock::now();
    return {};
  }

  Result<bool> read(std::vector<uint8_t>& bytes) override {
    if (is_stopped_) return false;
    if (std::exchange(is_header_, false)) return read_header(bytes);
    E2LF_ASSIGN_OR_RETURN(std::span<const uint8_t> ahead, source_->fetch(kWantedBytes));
    if (ahead.empty() && repeats_ > 0) {
      E2LF_RETURN_IF_ERROR(begin_again());
      E2LF_ASSIGN_OR_RETURN(ahead, source_->fetch(kWantedBytes));
    }
    if (ahead.empty()) return false;
    const size_t words = find_stretch(ahead.data(), ahead.size() / 2);
    const bool is_last = ahead.size() < kWantedBytes && 2 * words + 1 >= ahead.size();
    const size_t end = is_last ? ahead.size() : 2 * words;
    wait_until(time_us());
    bytes.assign(ahead.begin(), ahead.begin() + static_cast<ptrdiff_t>(end));
    source_->consume(end);
    if (moved_ != 0) move_time(bytes);
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
    words_begin_ = source_->position();
    return true;
  }

  /// Returns to the first word; the clock continues one step after the last word.
  Result<void> begin_again() {
    --repeats_;
    moved_ = static_cast<uint16_t>(moved_ + time_high_ + 1 - first_high_);
    time_high_ = static_cast<uint16_t>(kTimeHighBits | ((first_high_ - 1U) & evt3::kPayloadMask));
    return source_->seek(words_begin_);
  }

  void move_time(std::vector<uint8_t>& bytes) const {
    // Every word is stored unconditionally, so that the compiler vectorises the loop.
    uint8_t* const data = bytes.data();
    const size_t words = bytes.size() / 2;
    const uint16_t by = moved_;
    for (size_t i = 0; i < words; ++i) {
      const auto word = load_le<uint16_t>(data + 2 * i);
      const auto moved = static_cast<uint16_t>(kTimeHighBits | ((word + by) & evt3::kPayloadMask));
      store_le(data + 2 * i, (word & 0xF000U) == kTimeHighBits ? moved : word);
    }
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
    if (time_high_ == kUnknown) first_high_ = word;
    if (time_high_ != kUnknown && step <= kMostSteps) high_us_ += int64_t{step} << 12;
    time_high_ = word;
    low_us_ = 0;
  }

  /// Returns the time of the last word relative to the first TIME_HIGH word.
  [[nodiscard]] int64_t time_us() const { return high_us_ + low_us_; }

  /// Sleeps in steps that are short enough to be stopped.
  void wait_until(int64_t t_us) const {
    constexpr auto kNap = std::chrono::milliseconds(50);
    const Clock::time_point due = begin_ + std::chrono::microseconds(std::llround(static_cast<double>(t_us) / speed_));
    while (!is_stopped_ && Clock::now() < due) std::this_thread::sleep_until(std::min(due, Clock::now() + kNap));
  }

  static constexpr uint16_t kUnknown = 0xFFFF;
  static constexpr uint16_t kTimeHighBits = evt3::kTimeHigh << 12;

  SourcePtr source_;
  double speed_;
  uint64_t repeats_;       ///< number of remaining repetitions
  bool is_header_ = true;  ///< whether the header is delivered next
  uint64_t words_begin_ = 0;
  uint16_t time_high_ = kUnknown, first_high_ = 0;
  uint16_t moved_ = 0;  ///< shift of TIME_HIGH
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

CameraPtr make_raw_replay(SourcePtr source, const ReplayAddress& replay) {
  return std::make_unique<RawReplay>(std::move(source), replay);
}

}  // namespace e2lf::recordings
