// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/streams/receptor.h"

namespace e2lf::streams {

/// The signal that a pixel compares with its reference in one segment: its level, plus a straight line for noise and
/// leak.
class PixelSignal {
 public:
  /// Makes the signal of the pixel in `lane` of a block whose nodes are computed. The line has the value `offset` at
  /// the beginning of the segment.
  PixelSignal(const ReceptorSegment& segment, const ReceptorBlock& block, size_t lane, double offset,
              double slope_per_s)
      : segment_(segment),
        inverse_(block.inverse + lane),
        level_(block.level + lane),
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
