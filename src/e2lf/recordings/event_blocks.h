// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "e2lf/base/result.h"
#include "e2lf/recordings/event.h"
#include "e2lf/recordings/io/decode_summary.h"

namespace e2lf::recordings {

/// A source that delivers events in blocks of its own choice, as they are stored; the interface that formats implement.
/// One with triggers alone delivers those that are stored separately, in a second file or data set. It only decodes:
/// Timeline decides about order, damaged times and restarts of the clock, for all formats alike.
class EventBlocks {
 public:
  virtual ~EventBlocks() = default;

  /// Replaces `block` by the next one, which may be empty. Returns false at the end. A last event that is cut is
  /// counted as Violation::kTruncated, and one that cannot be read as kBadRecord. Events may be implausible, and
  /// triggers may be delivered before or after the events of their time.
  [[nodiscard]] virtual Result<bool> next(EventBatch& block, DecodeSummary& summary) = 0;

  /// Returns the position in the file of the block of the last next(); 0 = unknown.
  [[nodiscard]] virtual uint64_t block_byte() const { return 0; }

  /// Returns the size of an event in the file, in bytes; 0 = not constant.
  [[nodiscard]] virtual size_t event_bytes() const { return 0; }

  /// Returns whether the block of the last next() begins another recording at block_byte(), after a header or where the
  /// decoder found that the clock was reset. Its clock may have started again.
  [[nodiscard]] virtual bool begins_recording() const { return false; }

  /// Returns whether the decoder itself delivers plausible events and triggers in order of time, as that of RAW words
  /// does. They are then passed on without further checks.
  [[nodiscard]] virtual bool is_ordered() const { return false; }

  /// Limits the number of events of the following blocks, if blocks of this size are as cheap as others.
  virtual void limit_block(size_t /*max_events*/) {}

  /// RecordingReader::skip_events() in the times of next(). The default leaves out nothing.
  virtual void skip_events(int64_t /*begin_us*/, int64_t /*end_us*/) {}

  /// RecordingReader::arrival().
  [[nodiscard]] virtual std::optional<std::chrono::steady_clock::time_point> arrival() const { return std::nullopt; }

  /// Seeks to a block that begins before t_us, as close as is possible at low cost, or to the first block. Fails with
  /// kUnsupported and kIo.
  [[nodiscard]] virtual Result<void> seek_before(int64_t t_us) = 0;
};

using BlocksPtr = std::unique_ptr<EventBlocks>;

/// A batch that is returned in pieces, in an order in which everything that was returned is sorted.
class PendingBatch {
 public:
  /// Clears the batch and returns it for filling; memory is kept.
  EventBatch& refill() {
    batch_.clear();
    event_ = trigger_ = 0;
    return batch_;
  }

  [[nodiscard]] bool empty() const { return event_ == batch_.events.size() && trigger_ == batch_.triggers.size(); }
  [[nodiscard]] const EventBatch& batch() const { return batch_; }

  /// Skips the events and triggers before these indices.
  void skip_to(size_t event, size_t trigger) {
    event_ = event;
    trigger_ = trigger;
  }

  /// Appends at most `max_events` events and as many triggers to `out`. A complete batch is moved to an empty one
  /// without copying.
  void take(EventBatch& out, size_t max_events) {
    if (out.empty() && event_ == 0 && trigger_ == 0 && batch_.events.size() <= max_events &&
        batch_.triggers.size() <= max_events) {
      std::swap(out, batch_);
      refill();
      return;
    }
    const size_t event_end = std::min(batch_.events.size(), event_ + max_events);
    size_t trigger_end = batch_.triggers.size();
    if (event_end < batch_.events.size()) trigger_end = first_trigger(batch_.events.t[event_end]);
    trigger_end = std::min(trigger_end, trigger_ + max_events);
    out.events.append(batch_.events, event_, event_end);
    out.triggers.insert(out.triggers.end(), batch_.triggers.begin() + static_cast<ptrdiff_t>(trigger_),
                        batch_.triggers.begin() + static_cast<ptrdiff_t>(trigger_end));
    skip_to(event_end, trigger_end);
  }

  /// Return the index of the first remaining event or trigger at or after a time. Times need not be sorted.
  [[nodiscard]] size_t first_event(int64_t t_us) const {
    size_t i = event_;
    while (i < batch_.events.size() && batch_.events.t[i] < t_us) ++i;
    return i;
  }
  [[nodiscard]] size_t first_trigger(int64_t t_us) const {
    size_t i = trigger_;
    while (i < batch_.triggers.size() && batch_.triggers[i].t < t_us) ++i;
    return i;
  }

 private:
  EventBatch batch_;
  size_t event_ = 0;
  size_t trigger_ = 0;
};

/// Computes full times from the low kBits bits in records. A forward step of less than a quarter of the range (with 32
/// bits, 17 minutes) may wrap the clock; a backward step of this size is a late event, possibly from before the wrap;
/// larger steps are damage. If kMaxOdd records in a row contradict this, they are correct: there was a pause, or the
/// step before them was the damage.
template <int kBits>
class TimeUnwrapper {
 public:
  TimeUnwrapper() = default;
  /// Continues after a record with this time.
  explicit TimeUnwrapper(int64_t t_us) : base_us_(t_us & ~kMask), last_us_(t_us & kMask), has_begun_(true) {}

  int64_t operator()(int64_t low_us) {
    if (!has_begun_) {
      has_begun_ = true;
      last_us_ = low_us;
    }
    const int64_t ahead_us = (low_us - last_us_) & kMask;
    if (ahead_us < kQuarter) [[likely]] {
      if (low_us < last_us_) base_us_ += kMask + 1;
      last_us_ = low_us;
      num_odd_ = 0;
      return base_us_ + low_us;
    }
    const bool is_before_wrap = ahead_us >= 3 * kQuarter && low_us > last_us_ && base_us_ > 0;
    const int64_t base_us = is_before_wrap ? base_us_ - kMask - 1 : base_us_;
    if (++num_odd_ == kMaxOdd) *this = TimeUnwrapper(base_us + low_us);
    return base_us + low_us;
  }

 private:
  static constexpr int64_t kMask = (int64_t{1} << kBits) - 1;
  static constexpr int64_t kQuarter = int64_t{1} << (kBits - 2);
  static constexpr int kMaxOdd = 16;
  int64_t base_us_ = 0, last_us_ = 0;
  int num_odd_ = 0;  ///< number of consecutive records that do not continue from last_us_
  bool has_begun_ = false;
};

}  // namespace e2lf::recordings
