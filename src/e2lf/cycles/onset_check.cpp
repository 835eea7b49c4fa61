// SPDX-License-Identifier: MIT
#include "e2lf/cycles/onset_check.h"

#include <algorithm>

namespace e2lf::cycles {
namespace {

constexpr int64_t kBinUs = 100;
constexpr int64_t kSmoothedBins = 3;  // on either side of a rise
constexpr int64_t kMostReachUs = 5'000;
constexpr uint64_t kLeastEvents = 200;  // behind a rise
constexpr uint64_t kClearFactor = 3;    // of the events behind a rise to those in front of it
constexpr int64_t kAgreementUs = 500;
constexpr size_t kMostCounted = 8192;  // events of a call

int64_t quantile(std::vector<int64_t> values, double share) {
  const auto place = values.begin() + static_cast<ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

}  // namespace

void OnsetCheck::add_events(std::span<const int64_t> times_us) {
  if (times_us.empty()) return;
  if (!first_us_) {
    first_us_ = times_us.front();
    counts_.resize(kWatchedUs / kBinUs);
  }
  if (times_us.front() >= *first_us_ + kWatchedUs) return;
  // Of many events, some stand for all.
  const size_t stride = std::max<size_t>(times_us.size() / kMostCounted, 1);
  for (size_t i = 0; i < times_us.size(); i += stride) {
    const auto bin = static_cast<uint64_t>(times_us[i] - *first_us_) / static_cast<uint64_t>(kBinUs);
    if (bin >= counts_.size()) break;
    counts_[bin] += static_cast<uint32_t>(stride);
  }
}

void OnsetCheck::add_start(int64_t t_us) {
  if (starts_us_.empty() || t_us < starts_us_.front() + kWatchedUs) starts_us_.push_back(t_us);
}

std::optional<int64_t> OnsetCheck::onset_of(int64_t start_us, int64_t reach_us) const {
  const int64_t begin = (start_us - reach_us - *first_us_) / kBinUs, end = (start_us + reach_us - *first_us_) / kBinUs;
  if (begin < kSmoothedBins || end + kSmoothedBins > static_cast<int64_t>(counts_.size())) return std::nullopt;
  const auto sum = [&](int64_t first) {
    uint64_t events = 0;
    for (int64_t bin = first; bin < first + kSmoothedBins; ++bin) events += counts_[static_cast<size_t>(bin)];
    return events;
  };
  int64_t best = begin, best_rise = 0;
  for (int64_t bin = begin; bin < end; ++bin) {
    const int64_t rise = static_cast<int64_t>(sum(bin)) - static_cast<int64_t>(sum(bin - kSmoothedBins));
    if (rise > best_rise) {
      best = bin;
      best_rise = rise;
    }
  }
  const uint64_t behind = sum(best), before = sum(best - kSmoothedBins);
  if (behind < kLeastEvents || behind < kClearFactor * before) return std::nullopt;
  return *first_us_ + best * kBinUs - start_us;
}

std::optional<int64_t> OnsetCheck::onset_us() const {
  if (!first_us_ || starts_us_.size() < kMinStarts) return std::nullopt;
  int64_t reach_us = kMostReachUs;
  for (size_t i = 1; i < starts_us_.size(); ++i) {
    reach_us = std::min(reach_us, (starts_us_[i] - starts_us_[i - 1]) / 2);
  }
  std::vector<int64_t> onsets_us;
  for (const int64_t start_us : starts_us_) {
    if (const auto onset_us = onset_of(start_us, reach_us)) onsets_us.push_back(*onset_us);
  }
  if (onsets_us.size() < kMinStarts) return std::nullopt;
  if (quantile(onsets_us, 0.75) - quantile(onsets_us, 0.25) > kAgreementUs) return std::nullopt;
  return quantile(onsets_us, 0.5);
}

}  // namespace e2lf::cycles
