// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/streams/receptor.h"

namespace e2lf::streams {

/// What a pixel compares with its reference in one segment: its level, and a straight line for noise and leak.
class PixelSignal {
 public:
  /// Of the pixel in `lane` of a block whose nodes are computed. The line is `offset` at the segment's begin.
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

  /// At a time between `node` and the next.
  [[nodiscard]] double at(size_t node, double time_s) const { return evaluate(node, time_s).value; }

  /// When the signal, which rises (or falls) from from_s to to_s, is `target`, within a ten-thousandth of a
  /// microsecond; from_s where it is beyond already. Both times lie between `node` and the next, and at to_s it has
  /// reached the target.
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
