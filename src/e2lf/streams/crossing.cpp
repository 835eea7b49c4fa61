// SPDX-License-Identifier: MIT
#include "e2lf/streams/crossing.h"

#include <cmath>

namespace e2lf::streams {

PixelSignal::Value PixelSignal::evaluate(size_t node, double time_s) const {
  const double begin_s = segment_.time_s[node], amplifier_hz = segment_.amplifier_rate_hz;
  const double before = from_ + exposure_per_s_ * begin_s, now = from_ + exposure_per_s_ * time_s;
  double inverse = inverse_[node * kReceptorBlock];
  if (time_s > begin_s) inverse = follow_light(inverse, before, now, segment_.receptor_rate_hz, time_s - begin_s);
  const double log_intensity = -std::log(inverse);
  const double hold = std::exp(-amplifier_hz * (segment_.since_pattern_s + time_s));
  const double log_per_s = segment_.receptor_rate_hz * (now - 1.0 / inverse);
  return {log_intensity + (start_ - log_intensity) * hold + offset_ + slope_per_s_ * time_s,
          log_per_s * (1.0 - hold) + amplifier_hz * hold * (log_intensity - start_) + slope_per_s_};
}

double PixelSignal::find(size_t node, double from_s, double to_s, double target, bool is_rising) const {
  // Uses Newton steps as long as they stay within the known interval, and bisection otherwise.
  constexpr double kClose = 1e-10;
  constexpr int kMostSteps = 100;
  double time_s = from_s;
  for (int step = 0; step < kMostSteps && to_s - from_s > kClose; ++step) {
    const Value value = evaluate(node, time_s);
    const double miss = value.value - target;
    if (is_rising ? miss >= 0 : miss <= 0) {
      to_s = time_s;
      if (step == 0) break;
    } else {
      from_s = time_s;
    }
    const double next_s = time_s - miss / value.per_s;
    if (std::abs(next_s - time_s) < kClose) return next_s < from_s ? from_s : next_s > to_s ? to_s : next_s;
    time_s = next_s > from_s && next_s < to_s ? next_s : 0.5 * (from_s + to_s);
  }
  return to_s;
}

}  // namespace e2lf::streams
