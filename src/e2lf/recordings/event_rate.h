// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

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
  explicit EventRateCounter(size_t max_bins);

  void add(const EventBatch& batch);
  [[nodiscard]] const EventRate& rate() const { return rate_; }

 private:
  [[nodiscard]] size_t bin_of(int64_t t_us);

  size_t max_bins_;
  EventRate rate_;
};

}  // namespace e2lf::recordings
