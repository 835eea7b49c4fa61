// SPDX-License-Identifier: MIT
#include "e2lf/cycles/event_histogram.h"

#include <algorithm>
#include <cmath>

#include "e2lf/cycles/event_runs.h"
#include "e2lf/recordings/count_on.h"

namespace e2lf::cycles {
namespace {

/// Rises of this many standard deviations are half certain.
constexpr double kHalfCertain = 10;

}  // namespace

int64_t EventHistogram::bin_of(int64_t t_us) {
  const int64_t remainder = t_us % kBinUs;
  return t_us - remainder - (remainder < 0 ? kBinUs : 0);
}

void EventHistogram::add(const recordings::EventColumns& events, size_t begin, size_t end) {
  for (size_t i = begin; i < end;) {
    const int64_t bin_us = bin_of(events.t[i]);
    Counts& counts = bins_[bin_us];
    const size_t run_end = end_of_run(events, i, end, bin_us + kBinUs);
    const uint64_t on = recordings::count_on({events.p.data() + i, run_end - i});
    counts.on += static_cast<uint32_t>(on);
    counts.off += static_cast<uint32_t>(run_end - i - on);
    i = run_end;
  }
}

EventHistogram::Counts EventHistogram::count(int64_t begin_us, int64_t end_us) const {
  Counts sum;
  for (auto bin = bins_.lower_bound(begin_us); bin != bins_.end() && bin->first < end_us; ++bin) {
    sum.on += bin->second.on;
    sum.off += bin->second.off;
  }
  return sum;
}

void EventHistogram::forget_before(int64_t t_us) {
  bins_.erase(bins_.begin(), bins_.lower_bound(t_us));
}

EventRise event_rise(const EventHistogram& histogram, int64_t t_us, int64_t window_us) {
  const int64_t begin_us = EventHistogram::bin_of(t_us);
  const EventHistogram::Counts before = histogram.count(begin_us - window_us, begin_us);
  const EventHistogram::Counts after = histogram.count(begin_us, begin_us + window_us);
  EventRise rise;
  rise.on = std::max(0.0, static_cast<double>(after.on) - before.on);
  rise.off = std::max(0.0, static_cast<double>(after.off) - before.off);
  rise.all = static_cast<double>(before.on) + before.off + after.on + after.off;
  rise.significance = rise.total() / std::sqrt(rise.all + 1);
  return rise;
}

float change_confidence(const EventRise& rise, BurstSign sign) {
  if (rise.significance <= kHalfCertain / 2) return 0.0F;
  const double certainty = 1 - kHalfCertain / (2 * rise.significance);
  const double right = sign == BurstSign::kAny ? rise.total() : sign == BurstSign::kOn ? rise.on : rise.off;
  const double agreement = std::max(0.0, 2 * right / rise.total() - 1);
  return static_cast<float>(certainty * agreement * rise.total() / rise.all);
}

}  // namespace e2lf::cycles
