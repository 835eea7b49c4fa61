// SPDX-License-Identifier: MIT
#include "e2lf/diagnose/event_delay.h"

#include <algorithm>

namespace e2lf::diagnose {
namespace {

constexpr int64_t kBinUs = 100;
constexpr int64_t kSmoothedBins = 5;  // on either side of a rise
constexpr int64_t kMostReachUs = 5'000;
constexpr double kChanceShare = 0.02;   // of the largest rate
constexpr uint64_t kLeastEvents = 200;  // after the rise
constexpr uint64_t kClearFactor = 2;    // ratio of the events after the rise to those before it
constexpr size_t kMostCounted = 8192;   // events per call

}  // namespace

void EventDelay::add_events(std::span<const int64_t> times_us) {
  if (times_us.empty()) return;
  if (!first_us_) {
    first_us_ = times_us.front();
    counts_.resize(kWatchedUs / kBinUs);
  }
  if (times_us.front() >= *first_us_ + kWatchedUs) return;
  // A subset is sufficient if there are many events.
  const size_t stride = std::max<size_t>(times_us.size() / kMostCounted, 1);
  for (size_t i = 0; i < times_us.size(); i += stride) {
    const auto bin = static_cast<uint64_t>(times_us[i] - *first_us_) / static_cast<uint64_t>(kBinUs);
    if (bin >= counts_.size()) break;
    counts_[bin] += static_cast<uint32_t>(stride);
  }
}

void EventDelay::add_start(int64_t t_us) {
  if (starts_us_.empty() || t_us < starts_us_.front() + kWatchedUs) starts_us_.push_back(t_us);
}

std::vector<uint64_t> EventDelay::profile(int64_t reach_us) const {
  const int64_t bins = reach_us / kBinUs + kSmoothedBins;
  std::vector<uint64_t> sums(static_cast<size_t>(2 * bins));
  for (const int64_t start_us : starts_us_) {
    const int64_t begin = (start_us - *first_us_) / kBinUs - bins;
    if (start_us < *first_us_ || begin < 0 || begin + 2 * bins > static_cast<int64_t>(counts_.size())) continue;
    for (size_t i = 0; i < sums.size(); ++i) sums[i] += counts_[static_cast<size_t>(begin) + i];
  }
  return sums;
}

std::optional<int64_t> EventDelay::delay_us() const {
  if (!first_us_ || starts_us_.size() < kMinStarts) return std::nullopt;
  int64_t reach_us = kMostReachUs;
  for (size_t i = 1; i < starts_us_.size(); ++i) {
    reach_us = std::min(reach_us, (starts_us_[i] - starts_us_[i - 1]) / 2);
  }
  const std::vector<uint64_t> events = profile(reach_us);
  const auto sum = [&](size_t first) {
    uint64_t all = 0;
    for (size_t bin = first; bin < first + kSmoothedBins; ++bin) all += events[bin];
    return all;
  };
  // With slow pixels, the rate rises gradually; the first events are where it rises most relative to the previous rate.
  uint64_t most = 0;
  for (size_t bin = 0; bin + kSmoothedBins <= events.size(); ++bin) most = std::max(most, sum(bin));
  const double least = kChanceShare * static_cast<double>(most) + 1.0;  // smaller counts are chance
  size_t best = 0;
  double best_rise = 0;
  for (size_t bin = kSmoothedBins; bin + kSmoothedBins <= events.size(); ++bin) {
    const double rise =
        (static_cast<double>(sum(bin)) + least) / (static_cast<double>(sum(bin - kSmoothedBins)) + least);
    if (rise > best_rise) {
      best = bin;
      best_rise = rise;
    }
  }
  if (best == 0) return std::nullopt;
  const uint64_t behind = sum(best), before = sum(best - kSmoothedBins);
  if (behind < kLeastEvents || behind < kClearFactor * before) return std::nullopt;
  return (static_cast<int64_t>(best) - static_cast<int64_t>(events.size() / 2)) * kBinUs;
}

}  // namespace e2lf::diagnose
