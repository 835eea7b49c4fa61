// SPDX-License-Identifier: MIT
#include "e2lf/cycles/marks.h"

#include <cmath>
#include <utility>

#include "e2lf/base/result.h"

namespace e2lf::cycles {
namespace {

/// The time in which events after a trigger are compared with those before it.
constexpr int64_t kSignWindowUs = 1000;
/// The least significance of their rise, in standard deviations at a constant rate.
constexpr double kLeastSignSignificance = 10;
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
  /// Return the additional events of the signs that have more than before.
  [[nodiscard]] double on_rise() const { return std::max(0.0, on); }
  [[nodiscard]] double rise() const { return on_rise() + std::max(0.0, off); }
  /// Returns the significance of the rise, in standard deviations at a constant rate.
  [[nodiscard]] double significance() const { return rise() / std::sqrt(all + 1); }
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

float change_confidence(const EventHistogram& histogram, int64_t t_us, int64_t window_us, BurstSign sign) {
  const RateStep step = rate_step(histogram, EventHistogram::bin_of(t_us), window_us);
  if (step.rise() <= 0) return 0.0F;
  const double right = sign == BurstSign::kAny  ? step.rise()
                       : sign == BurstSign::kOn ? step.on_rise()
                                                : step.rise() - step.on_rise();
  const double agreement = std::max(0.0, 2 * right / step.rise() - 1);
  return static_cast<float>(certainty(step.significance()) * agreement * step.rise() / step.all);
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

void TriggerSigns::add(const recordings::EventColumns& events, const std::vector<Mark>& marks) {
  marks_.insert(marks_.end(), marks.begin(), marks.end());
  if (events.empty()) return;
  histogram_.add(events, 0, events.size());
  first_event_us_ = std::min(first_event_us_, events.t.front());
  last_event_us_ = std::max(last_event_us_, events.t.back());
  // Future triggers do not need the bins before this time.
  histogram_.forget_before(std::min(known_until(last_event_us_), last_event_us_) - 2 * kSignWindowUs);
}

std::optional<Mark> TriggerSigns::take(bool needs_sign, bool is_end) {
  if (marks_.empty()) return std::nullopt;
  Mark mark = marks_.front();
  if (needs_sign) {
    if (!is_end && last_event_us_ < mark.t_us + kSignWindowUs + EventHistogram::kBinUs) return std::nullopt;
    add_sign(mark);
  }
  marks_.pop_front();
  return mark;
}

/// Adds the sign of the rise at a trigger. It stays unknown if chance may have caused it, or at the beginning of the
/// recording, where the first events of the pixels are not informative.
void TriggerSigns::add_sign(Mark& mark) const {
  if (mark.t_us - kSignWindowUs < first_event_us_) return;
  const RateStep step = rate_step(histogram_, EventHistogram::bin_of(mark.t_us), kSignWindowUs);
  if (step.significance() < kLeastSignSignificance) return;
  mark.on_share = static_cast<float>(step.on_rise() / step.rise());
  mark.rise = step.rise();
}

namespace {

/// The largest number of empty bins inserted for a pause; longer pauses are equivalent.
constexpr int64_t kLongestPauseBins = 4096;
/// The weight of a new burst in the typical rise.
constexpr double kRiseLearningRate = 0.1;
/// Bins that exceed the level before the burst by this many standard deviations belong to it.
constexpr double kFootSignificance = 3;
/// The number of bins in which the rates before and after are compared, and the least between two bursts.
constexpr size_t kWindow = 10, kSpacing = 40;
constexpr int64_t kLeastSpacingUs = kSpacing * BurstDetector::kBinUs;
/// The least significance of the rise of the count, in standard deviations at a constant rate.
constexpr double kLeastSignificance = 10;
/// The least rise of the count, relative to the typical burst.
constexpr double kLeastRise = 0.1;

}  // namespace

void BurstDetector::add(const recordings::EventColumns& events, std::vector<Mark>& marks) {
  for (size_t i = 0; i < events.size();) {
    const int64_t bin = events.t[i] / kBinUs - (events.t[i] % kBinUs < 0);
    if (!has_begun_) {
      has_begun_ = true;
      open_bin_ = bin;
      begin_in_silence();
    }
    if (bin != open_bin_) close_bins(bin, marks);
    const size_t end = end_of_run(events, i, events.size(), (bin + 1) * kBinUs);
    const uint64_t on = recordings::count_on({events.p.data() + i, end - i});
    open_.on += static_cast<uint32_t>(on);
    open_.off += static_cast<uint32_t>(end - i - on);
    i = end;
  }
}

void BurstDetector::finish(std::vector<Mark>& marks) {
  if (has_begun_) close_bins(open_bin_ + static_cast<int64_t>(kWindow + kSpacing) + 1, marks);
}

int64_t BurstDetector::known_until_us() const {
  if (!has_begun_) return INT64_MIN;
  return (open_bin_ - static_cast<int64_t>(2 * kWindow + kSpacing)) * kBinUs;
}

/// Inserts empty bins before the open one, so that a burst at the very beginning of a recording is found.
void BurstDetector::begin_in_silence() {
  bins_.assign(kWindow + kSpacing, {});
  rises_.assign(kSpacing - kWindow + 1, {});
  first_bin_ = open_bin_ - static_cast<int64_t>(kWindow + kSpacing);
}

/// Completes the open bin and the empty ones after it.
void BurstDetector::close_bins(int64_t until_bin, std::vector<Mark>& marks) {
  const int64_t pause = until_bin - open_bin_;
  if (pause > kLongestPauseBins) {
    // The bins of a long pause are not stored individually: everything before it is judged, and silence is assumed
    // after it.
    const int64_t resume = until_bin;
    close_bins(open_bin_ + static_cast<int64_t>(2 * (kWindow + kSpacing)), marks);
    open_bin_ = resume;
    begin_in_silence();
    return;
  }
  for (; open_bin_ < until_bin; ++open_bin_) {
    bins_.push_back(std::exchange(open_, {}));
    judge(marks);
  }
}

BurstDetector::Rise BurstDetector::rise_at(size_t bin) const {
  double on[2] = {}, off[2] = {};
  for (size_t i = bin - kWindow; i < bin + kWindow; ++i) {
    on[i >= bin] += bins_[i].on;
    off[i >= bin] += bins_[i].off;
  }
  const double on_rise = std::max(0.0, on[1] - on[0]), off_rise = std::max(0.0, off[1] - off[0]);
  Rise rise;
  rise.count = on_rise + off_rise;
  const double chance = std::sqrt((on_rise > 0 ? on[0] + on[1] : 0) + (off_rise > 0 ? off[0] + off[1] : 0) + 1);
  rise.significance = rise.count / chance;
  if (rise.count > 0) rise.on_share = on_rise / rise.count;
  return rise;
}

/// Returns the bin in which the burst with the largest rise at `bin` begins: the first one clearly above the previous
/// level, or an earlier one directly before it that is above the level at all.
size_t BurstDetector::foot_of(size_t bin) const {
  const auto count = [&](size_t i) { return static_cast<double>(bins_[i].on + bins_[i].off); };
  // The nearer half of the window may already contain the rise.
  const size_t begin = bin - kWindow, settled = std::max<size_t>(1, kWindow / 2);
  double level = 0;
  for (size_t i = begin; i < begin + settled; ++i) level += count(i) / static_cast<double>(settled);
  size_t foot = begin + settled;
  while (foot + 1 < bin + kWindow && count(foot) <= level + kFootSignificance * std::sqrt(level + 1)) ++foot;
  while (foot > begin + settled && count(foot - 1) > level + std::sqrt(level)) --foot;
  return foot;
}

/// Judges the bin whose neighbourhood has just become complete, and drops data that are no longer needed.
void BurstDetector::judge(std::vector<Mark>& marks) {
  rises_.push_back(rise_at(bins_.size() - kWindow));
  if (rises_.size() < 2 * kSpacing + 1) return;
  // Rise i belongs to bin kWindow + i.
  const Rise& rise = rises_[kSpacing];
  const bool is_peak = std::none_of(rises_.begin(), rises_.end(), [&](const Rise& r) { return r.count > rise.count; });
  const size_t bin = kWindow + kSpacing;
  if (is_peak && rise.significance >= kLeastSignificance && rise.count >= kLeastRise * typical_rise_ &&
      time_of(bin) - last_mark_us_.value_or(INT64_MIN / 2) >= kLeastSpacingUs) {
    last_mark_us_ = time_of(bin);
    const auto certainty = static_cast<float>(1 - kLeastSignificance / (2 * rise.significance));
    marks.push_back({time_of(foot_of(bin)), static_cast<float>(rise.on_share), certainty, rise.count});
    typical_rise_ += (typical_rise_ == 0 ? 1 : kRiseLearningRate) * (rise.count - typical_rise_);
  }
  rises_.pop_front();
  bins_.pop_front();
  ++first_bin_;
}

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
