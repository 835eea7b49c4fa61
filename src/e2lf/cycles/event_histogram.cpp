// SPDX-License-Identifier: MIT
#include "e2lf/cycles/event_histogram.h"

#include <algorithm>
#include <cmath>

#include "e2lf/recordings/event.h"

namespace e2lf::cycles {
namespace {

/// A rise of this many standard deviations has a certainty of one half.
constexpr double kHalfCertain = 10;

/// Returns 0 for a significance that chance can reach, rising towards 1 for larger ones.
double certainty(double significance) {
  return significance <= kHalfCertain / 2 ? 0.0 : 1 - kHalfCertain / (2 * significance);
}

/// The difference between the counts after and before a time, in windows of one length.
struct RateStep {
  double on = 0, off = 0;  ///< additional events compared with before; negative if fewer
  double all = 0;          ///< in both windows

  [[nodiscard]] double size() const { return std::abs(on) + std::abs(off); }
  /// Returns the part that makes the picture brighter: ON events that begin and OFF events that end.
  [[nodiscard]] double brighter() const { return std::max(0.0, on) + std::max(0.0, -off); }
};

RateStep rate_step(const EventHistogram& histogram, int64_t begin_us, int64_t length_us) {
  const EventHistogram::Counts before = histogram.count(begin_us - length_us, begin_us);
  const EventHistogram::Counts after = histogram.count(begin_us, begin_us + length_us);
  return {static_cast<double>(after.on) - before.on, static_cast<double>(after.off) - before.off,
          static_cast<double>(before.on) + before.off + after.on + after.off};
}

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
  const RateStep step = rate_step(histogram, EventHistogram::bin_of(t_us), window_us);
  EventRise rise{.on = std::max(0.0, step.on), .off = std::max(0.0, step.off), .all = step.all};
  rise.significance = rise.total() / std::sqrt(rise.all + 1);
  return rise;
}

float change_confidence(const EventRise& rise, BurstSign sign) {
  if (rise.total() <= 0) return 0.0F;
  const double right = sign == BurstSign::kAny ? rise.total() : sign == BurstSign::kOn ? rise.on : rise.off;
  const double agreement = std::max(0.0, 2 * right / rise.total() - 1);
  return static_cast<float>(certainty(rise.significance) * agreement * rise.total() / rise.all);
}

float abrupt_change_confidence(const EventHistogram& histogram, int64_t t_us, int64_t window_us, BurstSign sign) {
  const int64_t begin_us = EventHistogram::bin_of(t_us), length_us = window_us / 2;
  const RateStep here = rate_step(histogram, begin_us, length_us);
  const double sure = certainty(here.size() / std::sqrt(here.all + 1));
  if (sure <= 0) return 0.0F;
  double greatest = here.size();
  for (int64_t away_us = EventHistogram::kBinUs; away_us <= window_us; away_us += EventHistogram::kBinUs) {
    for (const int64_t t : {begin_us - away_us, begin_us + away_us}) {
      greatest = std::max(greatest, rate_step(histogram, t, length_us).size());
    }
  }
  const double far_away = 0.5 * (rate_step(histogram, begin_us - window_us, length_us).size() +
                                 rate_step(histogram, begin_us + window_us, length_us).size());
  const double sharpness = std::max(0.0, 1 - far_away / here.size());
  const double right = sign == BurstSign::kAny  ? here.size()
                       : sign == BurstSign::kOn ? here.brighter()
                                                : here.size() - here.brighter();
  const double agreement = std::max(0.0, 2 * right / here.size() - 1);
  return static_cast<float>(sure * agreement * sharpness * here.size() / greatest);
}

}  // namespace e2lf::cycles
