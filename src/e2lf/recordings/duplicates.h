// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "e2lf/recordings/event.h"

namespace e2lf::recordings {

/// Counts exact duplicates: events whose x, y, p and t equal those of an earlier event. Pixels have a dead time, so a
/// sensor generates none; they come from packets that were sent or written twice, or from files that were joined.
///
/// A table of fixed size holds the events of the current time. Where more than about 100,000 events share one time, it
/// forgets some of them, so that the count is a lower bound; it is never too large.
class DuplicateCounter {
 public:
  /// Adds the next events of a recording, which are in order of time.
  void add(const EventColumns& events) {
    for (size_t i = 0; i < events.size(); ++i) {
      if (events.t[i] != last_us_) {
        last_us_ = events.t[i];
        time_number_ += 1;
      }
      const uint64_t place = uint64_t{events.x[i]} << 17 | uint64_t{events.y[i]} << 1 | events.p[i];
      const uint64_t entry = time_number_ << kPlaceBits | place;
      uint64_t& slot = slots_[place * kHashFactor >> (64 - kSlotBits)];
      duplicates_ += slot == entry ? 1 : 0;
      slot = entry;
    }
    events_ += events.size();
  }

  [[nodiscard]] uint64_t duplicates() const { return duplicates_; }

  /// Returns the part of all events that are duplicates, in [0, 1); 0 without events.
  [[nodiscard]] double share() const {
    return events_ == 0 ? 0.0 : static_cast<double>(duplicates_) / static_cast<double>(events_);
  }

 private:
  static constexpr unsigned kPlaceBits = 33;  ///< x, y and p; the other bits number the times modulo 2^31
  static constexpr unsigned kSlotBits = 16;
  static constexpr uint64_t kHashFactor = 0x9E3779B97F4A7C15;  // 2^64 divided by the golden ratio

  std::vector<uint64_t> slots_ = std::vector<uint64_t>(size_t{1} << kSlotBits);
  uint64_t time_number_ = 0;  ///< of last_us_, counted from 1, so that an empty slot equals no event
  int64_t last_us_ = INT64_MIN;
  uint64_t duplicates_ = 0, events_ = 0;
};

}  // namespace e2lf::recordings
