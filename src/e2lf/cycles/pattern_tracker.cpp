// SPDX-License-Identifier: MIT
#include "e2lf/cycles/pattern_tracker.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/result.h"

namespace e2lf::cycles {
namespace {

/// The weight of a new interval in the expected one.
constexpr double kLearningRate = 0.1;
/// The number of cycles without a mark after which the pattern is searched anew.
constexpr size_t kMaxCyclesWithoutMark = 3;

}  // namespace

PatternTracker::PatternTracker(const Schedule& schedule, const TrackerOptions& options)
    : schedule_(schedule), options_(options) {
  E2LF_REQUIRE(schedule.size() > 0, "a schedule without patterns");
  E2LF_REQUIRE(!options.first_pattern || *options.first_pattern < schedule.size(), "the first pattern does not exist");
  for (const ScheduledPattern& pattern : schedule.patterns) {
    interval_us_.push_back(static_cast<double>(pattern.interval_us()));
  }
}

int64_t PatternTracker::known_until(int64_t t_us) const {
  return found_.empty() ? t_us : std::min(t_us, found_.front().t_us);
}

void PatternTracker::add(const Mark& mark, std::vector<PatternStart>& starts) {
  const double since_last_us = last_mark_us_ ? static_cast<double>(mark.t_us) - static_cast<double>(*last_mark_us_) : 0;
  if (last_mark_us_ && since_last_us < kBounceShare * *std::ranges::min_element(interval_us_)) return;
  last_mark_us_ = mark.t_us;
  if (std::exchange(is_first_, false) && options_.first_pattern) {
    pattern_ = *options_.first_pattern;
    has_locked_ = true;
    last_us_ = mark.t_us;
    starts.push_back({mark.t_us, *pattern_, PatternStart::Kind::kSeen, mark.confidence});
    return;
  }
  if (pattern_ && follow(mark, starts)) return;
  if (pattern_) {
    starts.push_back({mark.t_us, *pattern_, PatternStart::Kind::kLost, mark.confidence});
    pattern_.reset();
    misfits_ = 0;
  }
  found_.push_back(mark);
  search(starts);
}

/// Once a whole cycle of marks matches in a single way, all of them are known; otherwise, the oldest one is given up.
void PatternTracker::search(std::vector<PatternStart>& starts) {
  if (found_.size() <= interval_us_.size() || lock(starts)) return;
  found_.pop_front();
  ++unassigned_;
}

/// A recording of a single cycle has no mark after it.
void PatternTracker::finish(std::vector<PatternStart>& starts) {
  if (!pattern_ && found_.size() == interval_us_.size()) static_cast<void>(lock(starts));
}

/// Assigns patterns to the marks found, if they can be determined.
bool PatternTracker::lock(std::vector<PatternStart>& starts) {
  const auto phase = find_phase();
  if (!phase) return false;
  for (size_t i = 0; i < found_.size(); ++i) {
    if (i > 0) learn(after(*phase, i - 1), static_cast<double>(found_[i].t_us - found_[i - 1].t_us));
    starts.push_back({found_[i].t_us, after(*phase, i), PatternStart::Kind::kSeen, found_[i].confidence});
  }
  pattern_ = starts.back().pattern;
  last_us_ = found_.back().t_us;
  found_.clear();
  has_locked_ = true;
  return true;
}

std::optional<size_t> PatternTracker::find_phase() {
  std::vector<size_t> best;
  float best_score = 0;
  for (size_t phase = 0; phase < interval_us_.size(); ++phase) {
    const auto score = phase_score(phase);
    if (!score || (!best.empty() && *score < best_score)) continue;
    if (best.empty() || *score > best_score) best.clear();
    best.push_back(phase);
    best_score = *score;
  }
  if (best.size() == 1) return best.front();
  const bool is_very_first = !has_locked_ && unassigned_ == 0;
  const auto& likely = options_.likely_first_pattern;
  if (!is_very_first || !likely || std::find(best.begin(), best.end(), *likely) == best.end()) return std::nullopt;
  has_assumed_first_ = true;
  return likely;
}

/// Returns how well the signs of the marks agree if the first of them begins pattern `phase`, or nothing if an interval
/// or the signs contradict it. Strong bursts count for more: the noise of pixels whose reference lags behind the light
/// can exceed the change from white to a pattern that is nearly white, so that this one has the wrong sign.
std::optional<float> PatternTracker::phase_score(size_t phase) const {
  float score = 0;
  for (size_t i = 0; i < found_.size(); ++i) {
    const size_t pattern = after(phase, i);
    if (i + 1 < found_.size()) {
      const auto interval_us = static_cast<double>(found_[i + 1].t_us - found_[i].t_us);
      if (std::abs(interval_us - interval_us_[pattern]) > options_.tolerance * interval_us_[pattern]) return {};
    }
    const BurstSign sign = schedule_.patterns[pattern].sign;
    if (!found_[i].on_share || sign == BurstSign::kAny) continue;
    const float agreement = (sign == BurstSign::kOn ? 1.0F : -1.0F) * (2 * *found_[i].on_share - 1);
    score += static_cast<float>(std::sqrt(found_[i].rise)) * agreement;
  }
  if (score < 0) return {};
  return score;
}

/// Assigns a pattern to the mark after the last one. Returns false if the marks no longer follow the schedule.
bool PatternTracker::follow(const Mark& mark, std::vector<PatternStart>& starts) {
  const size_t max_steps = kMaxCyclesWithoutMark * interval_us_.size();
  std::vector<PatternStart> missing;
  size_t pattern = *pattern_;
  auto expected_us = static_cast<double>(last_us_);
  for (size_t steps = 0; steps < max_steps; ++steps) {
    const double tolerance_us = options_.tolerance * interval_us_[pattern];
    const double start_us = expected_us;
    expected_us += interval_us_[pattern];
    const double error_us = static_cast<double>(mark.t_us) - expected_us;
    if (error_us > tolerance_us) {
      pattern = after(pattern);
      missing.push_back({static_cast<int64_t>(expected_us), pattern, PatternStart::Kind::kMissing, 0.0F});
      continue;
    }
    starts.insert(starts.end(), missing.begin(), missing.end());
    if (error_us < -tolerance_us) {
      // There is an additional mark between two expected ones. As many of them in a row as patterns indicate another
      // schedule.
      if (++misfits_ >= interval_us_.size()) return false;
      starts.push_back({mark.t_us, pattern, PatternStart::Kind::kDoubled, mark.confidence});
      pattern_ = pattern;
      last_us_ = static_cast<int64_t>(start_us);
      return true;
    }
    misfits_ = 0;
    if (steps == 0) learn(pattern, static_cast<double>(mark.t_us - last_us_));
    const auto fit = static_cast<float>(1 - std::abs(error_us) / tolerance_us);
    pattern_ = after(pattern);
    last_us_ = mark.t_us;
    starts.push_back({mark.t_us, *pattern_, PatternStart::Kind::kSeen, mark.confidence * std::sqrt(fit)});
    return true;
  }
  return false;
}

void PatternTracker::learn(size_t pattern, double interval_us) {
  interval_us_[pattern] += kLearningRate * (interval_us - interval_us_[pattern]);
}

}  // namespace e2lf::cycles
