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

}  // namespace e2lf::recordings
