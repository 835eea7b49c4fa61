// SPDX-License-Identifier: MIT
#include "e2lf/streams/receptor.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "e2lf/streams/receptor.cpp"
// The first of these includes this file again, once for each instruction set; the last must come after it.
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace e2lf::streams::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

/// The vector version of follow_light().
HWY_INLINE V FollowLight(D d, V inverse, V from, V to, V rate, V time) {
  const V one = hn::Set(d, 1.0), two = hn::Set(d, 2.0);
  const V half_distance = hn::Mul(hn::Mul(rate, hn::Set(d, 0.5)), time);
  const V decay = hn::Exp(d, hn::Neg(hn::Mul(half_distance, hn::Add(from, to))));
  if (hn::AllTrue(d, hn::Eq(from, to))) {
    const V target = hn::Div(one, to);
    return hn::MulAdd(hn::Sub(inverse, target), decay, target);
  }
  const V x = hn::Mul(hn::Mul(rate, to), time), e = hn::Exp(d, hn::Neg(x));
  const V cube = hn::Mul(hn::Mul(x, x), hn::Mul(x, hn::Set(d, 1.0 / 3)));
  const V curvature =
      hn::IfThenElse(hn::Lt(x, hn::Set(d, 1e-3)), cube, hn::Sub(two, hn::Mul(e, hn::MulAdd(x, hn::Add(x, two), two))));
  const V change = hn::Div(hn::Sub(to, from), hn::Mul(time, hn::Mul(hn::Mul(two, rate), hn::Mul(to, to))));
  const V gone = hn::Sub(one, e);
  const V share = hn::Div(hn::Mul(change, curvature), gone), added = hn::Div(gone, to);
  const V sum = hn::IfThenElse(hn::Gt(share, hn::Zero(d)), hn::Mul(added, hn::Add(one, share)),
                               hn::Div(added, hn::Sub(one, share)));
  return hn::MulAdd(inverse, decay, sum);
}

void ReceptorNodes(const ReceptorSegment& segment, ReceptorBlock& block, size_t count) {
  const D d;
  const V rate = hn::Set(d, segment.receptor_rate_hz), duration = hn::Set(d, segment.duration_s);
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const V from = hn::LoadU(d, block.from.data() + i), start = hn::LoadU(d, block.start.data() + i);
    const V slope = hn::Div(hn::Sub(hn::LoadU(d, block.to.data() + i), from), duration);
    V inverse = hn::LoadU(d, block.inverse.data() + i), before = from;
    for (size_t node = 0; node < kReceptorNodes; ++node) {
      if (node > 0) {
        const V now = hn::MulAdd(slope, hn::Set(d, segment.time_s[node]), from);
        const V time = hn::Set(d, segment.time_s[node] - segment.time_s[node - 1]);
        inverse = FollowLight(d, inverse, before, now, rate, time);
        hn::StoreU(inverse, d, block.inverse.data() + node * kReceptorBlock + i);
        before = now;
      }
      const V log_intensity = hn::Neg(hn::Log(d, inverse));
      const V level = hn::MulAdd(hn::Sub(start, log_intensity), hn::Set(d, segment.hold[node]), log_intensity);
      hn::StoreU(level, d, block.level.data() + node * kReceptorBlock + i);
    }
  }
}

}  // namespace e2lf::streams::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace e2lf::streams {

HWY_EXPORT(ReceptorNodes);

ReceptorSegment::ReceptorSegment(double receptor_rate, double amplifier_rate, double duration, double since_pattern,
                                 bool is_ramp)
    : receptor_rate_hz(receptor_rate),
      amplifier_rate_hz(amplifier_rate),
      duration_s(duration),
      since_pattern_s(since_pattern) {
  for (size_t node = 0; node < kReceptorNodes; ++node) {
    const double share = static_cast<double>(node) / static_cast<double>(kReceptorNodes - 1);
    time_s[node] = duration * (is_ramp ? share : share * share);
    hold[node] = std::exp(-amplifier_rate * (since_pattern + time_s[node]));
  }
}

void receptor_nodes(const ReceptorSegment& segment, ReceptorBlock& block, size_t count) {
  HWY_DYNAMIC_DISPATCH(ReceptorNodes)(segment, block, count);
}

void reference_receptor_nodes(const ReceptorSegment& segment, ReceptorBlock& block, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    const double slope = (block.to[i] - block.from[i]) / segment.duration_s;
    for (size_t node = 0; node < kReceptorNodes; ++node) {
      double& inverse = block.inverse[node * kReceptorBlock + i];
      if (node > 0) {
        const double before_s = segment.time_s[node - 1], time_s = segment.time_s[node];
        inverse = follow_light(block.inverse[(node - 1) * kReceptorBlock + i], block.from[i] + slope * before_s,
                               block.from[i] + slope * time_s, segment.receptor_rate_hz, time_s - before_s);
      }
      const double log_intensity = -std::log(inverse);
      block.level[node * kReceptorBlock + i] = log_intensity + (block.start[i] - log_intensity) * segment.hold[node];
    }
  }
}

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
#endif
