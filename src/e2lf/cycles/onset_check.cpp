// SPDX-License-Identifier: MIT
#include "e2lf/cycles/onset_check.h"

#include <algorithm>

namespace e2lf::cycles {
namespace {

constexpr int64_t kBinUs = 100;
constexpr int64_t kWindowBins = 3;  // on either side of a change
constexpr int64_t kMostReachUs = 5'000;
constexpr double kLeastScore = 10;     // per start; chance alone makes 1
constexpr double kClearFactor = 3;     // of the best time's score to the median over all times
constexpr size_t kMostCounted = 8192;  // events of a call

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

double OnsetCheck::score_at(int64_t offset_us) const {
  double score = 0;
  for (const int64_t start_us : starts_us_) {
    const int64_t bin = (start_us + offset_us - *first_us_) / kBinUs;
    if (bin < kWindowBins || bin + kWindowBins > static_cast<int64_t>(counts_.size())) continue;
    double before = 0, behind = 0;
    for (int64_t i = 0; i < kWindowBins; ++i) {
      before += counts_[static_cast<size_t>(bin - 1 - i)];
      behind += counts_[static_cast<size_t>(bin + i)];
    }
    if (before + behind > 0) score += (behind - before) * (behind - before) / (behind + before);
  }
  return score;
}

std::optional<int64_t> OnsetCheck::onset_us() const {
  if (!first_us_ || starts_us_.size() < kMinStarts) return std::nullopt;
  int64_t reach_us = kMostReachUs;
  for (size_t i = 1; i < starts_us_.size(); ++i) {
    reach_us = std::min(reach_us, (starts_us_[i] - starts_us_[i - 1]) / 2);
  }
  const int64_t reach = reach_us / kBinUs;
  std::vector<double> scores;
  for (int64_t offset = -reach; offset <= reach; ++offset) scores.push_back(score_at(offset * kBinUs));
  const auto best = std::max_element(scores.begin(), scores.end());
  const int64_t onset_us = (best - scores.begin() - reach) * kBinUs;
  const double best_score = *best;
  const auto middle = scores.begin() + static_cast<ptrdiff_t>(scores.size() / 2);
  std::nth_element(scores.begin(), middle, scores.end());
  const bool is_clear =
      best_score >= kLeastScore * static_cast<double>(starts_us_.size()) && best_score >= kClearFactor * *middle;
  return is_clear ? std::optional(onset_us) : std::nullopt;
}

}  // namespace e2lf::cycles
