// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace e2lf::streams {

/// The number of times in a segment at which levels are computed. After a jump of light, they are denser at its
/// beginning. Between two of them, a level is assumed to be monotonic.
inline constexpr size_t kReceptorNodes = 13;

/// Photoreceptor and amplifier in one segment, common to all pixels. The log intensity u of the photoreceptor obeys
/// du/dt = K (J - exp u), J = (I + eps) / eps: w = exp(-u) relaxes to 1 / J at the rate K J. The level relaxes from its
/// value at the beginning of the pattern to u: level = u + (start - u) exp(-A t), where t is the time since then.
struct ReceptorSegment {
  double receptor_rate_hz = 0.0, amplifier_rate_hz = 0.0;
  double duration_s = 0.0, since_pattern_s = 0.0;  ///< the latter is the start of the segment within the pattern
  std::array<double, kReceptorNodes> time_s = {};  ///< since the beginning of the segment; the last one is its end
  std::array<double, kReceptorNodes> hold = {};    ///< exp(-A t) at these times

  /// `is_ramp` states that the light changes during the segment.
  ReceptorSegment(double receptor_rate, double amplifier_rate, double duration, double since_pattern, bool is_ramp);
};

/// Returns w at the end of a period in which J changes linearly from `from` to `to`: the remainder of the initial w,
/// plus what the equation dw/dt = K (1 - J w) has added since. It is exact for constant J. Otherwise, the added part is
/// accurate to first order in the curvature of the integral of K J, so the period must be short.
inline double follow_light(double inverse, double from, double to, double receptor_rate_hz, double time_s) {
  const double decay = std::exp(-receptor_rate_hz * 0.5 * (from + to) * time_s);
  if (from == to) return 1.0 / to + (inverse - 1.0 / to) * decay;
  const double x = receptor_rate_hz * to * time_s, e = std::exp(-x);
  constexpr double kSmall = 1e-3;  // below this, the difference would lose its digits
  const double curvature = x < kSmall ? x * x * x / 3 : 2.0 - e * (x * (x + 2.0) + 2.0);
  const double share = (to - from) / time_s / (2 * receptor_rate_hz * to * to) * curvature / (1.0 - e);
  const double added = (1.0 - e) / to;
  return inverse * decay + (share > 0 ? added * (1.0 + share) : added / (1.0 - share));
}

/// Consecutive pixels.
inline constexpr size_t kReceptorBlock = 256;
struct ReceptorBlock {
  std::vector<double> from = std::vector<double>(kReceptorBlock);  ///< J at the beginning of the segment
  std::vector<double> to = from;                                   ///< J at its end
  std::vector<double> start = from;                                ///< the level at the beginning of the pattern
  std::vector<double> inverse =
      std::vector<double>(kReceptorBlock * kReceptorNodes);  ///< w [node][pixel]; the values of node 0 are given
  std::vector<double> level = inverse;                       ///< [node][pixel]
};

/// Compute w and the level at each node for the first `count` pixels. Entries up to the next multiple of the vector
/// length are overwritten, too. Both versions agree within a few units in the last place.
void receptor_nodes(const ReceptorSegment& segment, ReceptorBlock& block, size_t count);
void reference_receptor_nodes(const ReceptorSegment& segment, ReceptorBlock& block, size_t count);

/// The signal that a pixel compares with its reference in one segment: its level, plus a straight line for noise and
/// leak.
class PixelSignal {
 public:
  /// Makes the signal of the pixel in `lane` of a block whose nodes are computed. The line has the value `offset` at
  /// the beginning of the segment.
  PixelSignal(const ReceptorSegment& segment, const ReceptorBlock& block, size_t lane, double offset,
              double slope_per_s)
      : segment_(segment),
        inverse_(block.inverse.data() + lane),
        level_(block.level.data() + lane),
        from_(block.from[lane]),
        exposure_per_s_((block.to[lane] - block.from[lane]) / segment.duration_s),
        start_(block.start[lane]),
        offset_(offset),
        slope_per_s_(slope_per_s) {}

  [[nodiscard]] double at_node(size_t node) const {
    return level_[node * kReceptorBlock] + offset_ + slope_per_s_ * segment_.time_s[node];
  }

  /// Returns the signal at a time between `node` and the next one.
  [[nodiscard]] double at(size_t node, double time_s) const { return evaluate(node, time_s).value; }

  /// Returns the time at which the signal, which is rising (or falling) from from_s to to_s, reaches `target`, accurate
  /// to 1e-4 us, or from_s if it is already beyond. Both times must lie between `node` and the next one, and the signal
  /// must have reached the target at to_s.
  [[nodiscard]] double find(size_t node, double from_s, double to_s, double target, bool is_rising) const;

 private:
  struct Value {
    double value, per_s;
  };
  [[nodiscard]] Value evaluate(size_t node, double time_s) const;

  const ReceptorSegment& segment_;
  const double *inverse_, *level_;
  double from_, exposure_per_s_, start_, offset_, slope_per_s_;
};

}  // namespace e2lf::streams
