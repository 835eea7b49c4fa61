// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

/// The number of events in each time bin.
struct EventRate {
  int64_t begin_us = 0;  ///< start of the first bin
  int64_t bin_us = 1;
  std::vector<uint64_t> on, off;
  std::vector<uint64_t> triggers;  ///< edges of all inputs

  [[nodiscard]] size_t size() const { return on.size(); }
};

/// Counts events that arrive in batches in at most max_bins (>= 2) bins, as narrow as this permits. Whenever there are
/// too many bins, pairs are merged, so that memory does not depend on the length of the recording.
class EventRateCounter {
 public:
  explicit EventRateCounter(size_t max_bins) : max_bins_(max_bins) { E2LF_REQUIRE(max_bins >= 2, "at least two bins"); }

  void add(const EventBatch& batch) {
    for (size_t i = 0; i < batch.events.size(); ++i) {
      const size_t bin = bin_of(batch.events.t[i]);
      ++(batch.events.p[i] != 0 ? rate_.on : rate_.off)[bin];
    }
    for (const Trigger& trigger : batch.triggers) {
      const size_t bin = bin_of(trigger.t);
      ++rate_.triggers[bin];
    }
  }
  [[nodiscard]] const EventRate& rate() const { return rate_; }

 private:
  /// Returns the bin of a time, and adds bins as necessary.
  [[nodiscard]] size_t bin_of(int64_t t_us) {
    if (rate_.size() == 0) rate_.begin_us = t_us;
    // A trigger may be slightly before the first event that was read.
    const int64_t since_us = std::max<int64_t>(0, t_us - rate_.begin_us);
    while (static_cast<uint64_t>(since_us / rate_.bin_us) >= max_bins_) {
      for (auto* counts : {&rate_.on, &rate_.off, &rate_.triggers}) merge_pairs(*counts);
      rate_.bin_us *= 2;
    }
    const auto bin = static_cast<size_t>(since_us / rate_.bin_us);
    if (bin >= rate_.size()) {
      for (auto* counts : {&rate_.on, &rate_.off, &rate_.triggers}) counts->resize(bin + 1);
    }
    return bin;
  }

  /// Adds neighbouring bins, which halves their number.
  static void merge_pairs(std::vector<uint64_t>& counts) {
    for (size_t i = 0; i < counts.size(); i += 2) {
      counts[i / 2] = counts[i] + (i + 1 < counts.size() ? counts[i + 1] : 0);
    }
    counts.resize((counts.size() + 1) / 2);
  }

  size_t max_bins_;
  EventRate rate_;
};

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
