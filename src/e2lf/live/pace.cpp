// SPDX-License-Identifier: MIT
#include "e2lf/live/pace.h"

#include <algorithm>

#include "e2lf/base/result.h"

namespace e2lf::live {

Pace::Pace(const std::vector<double>& macs_per_pixel, std::optional<PictureSize> named) {
  E2LF_REQUIRE(!macs_per_pixel.empty(), "without a network there is no pace");
  // Better networks are for the first size alone: a sharper picture is worth more than a better one that is coarser.
  for (const PictureSize size : {PictureSize::kFull, PictureSize::kHalf, PictureSize::kQuarter}) {
    if (named && size != *named) continue;
    const auto side = static_cast<double>(block_side(size));
    const size_t first = steps_.empty() ? 0 : macs_per_pixel.size() - 1;
    for (size_t network = first; network < macs_per_pixel.size(); ++network) {
      steps_.push_back({{network, size}, macs_per_pixel[network] / (side * side)});
    }
  }
  step_ = steps_.size() - 1;
}

double LateCycles::most_s(double cycle_s) {
  constexpr double kCycles = 2, kLeastS = 0.05;
  return std::max(kCycles * cycle_s, kLeastS);
}

bool LateCycles::drops(double latency_s, double cycle_s) {
  const bool is_late = cycle_s > 0 && latency_s > most_s(cycle_s);
  const bool is_dropped = is_late && dropped_ < kMostDropped;
  dropped_ = is_dropped ? dropped_ + 1 : 0;
  return is_dropped;
}

bool Pace::add(double field_s, double cycle_s, bool is_late) {
  // The first field of a step also prepares its memory.
  constexpr size_t kFewest = 2, kBeforeRise = 20;
  // A reserve, so that the step does not change to and fro. At the start, steps are tried until one is too slow,
  // because a field has costs that do not grow with its size.
  constexpr double kReserve = 0.8, kTried = 1.25;
  constexpr int kMostFalls = 3;
  if (cycle_s <= 0 || measured_++ == 0) return false;
  sum_s_ += field_s;
  const double mean_s = sum_s_ / static_cast<double>(measured_ - 1);
  const auto rises = [&] {
    const size_t before = is_growing_ ? kFewest - 1 : kBeforeRise;
    if (is_late || step_ == 0 || measured_ <= before || steps_[step_ - 1].falls >= kMostFalls) return false;
    return mean_s * steps_[step_ - 1].cost / steps_[step_].cost <= (is_growing_ ? kTried : kReserve) * cycle_s;
  };
  const bool is_slow = mean_s > cycle_s;
  // A light field that is fast enough but late takes the processors from the reading, which may have lagged for a
  // while.
  if (measured_ > kFewest && (is_slow || is_late) && step_ + 1 < steps_.size()) {
    steps_[step_++].falls += is_slow ? 1 : 0;
    is_growing_ = false;
  } else if (rises()) {
    --step_;
  } else {
    return false;
  }
  measured_ = 0;
  sum_s_ = 0;
  return true;
}

}  // namespace e2lf::live
