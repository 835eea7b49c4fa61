// SPDX-License-Identifier: MIT
#include "e2lf/cycles/burst_detector.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/result.h"
#include "e2lf/cycles/event_histogram.h"
#include "e2lf/recordings/event.h"

namespace e2lf::cycles {
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
    marks.push_back({time_of(foot_of(bin)), static_cast<float>(rise.on_share), certainty});
    typical_rise_ += (typical_rise_ == 0 ? 1 : kRiseLearningRate) * (rise.count - typical_rise_);
  }
  rises_.pop_front();
  bins_.pop_front();
  ++first_bin_;
}

}  // namespace e2lf::cycles
