// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace e2lf::streams {

/// The moments of a segment at which levels are computed; after a jump of light closer together at its begin. Between
/// two of them a level is taken to rise or to fall only.
inline constexpr size_t kReceptorNodes = 13;

/// Photoreceptor and amplifier in one segment, the same for all pixels. u is the photoreceptor's log intensity,
/// du/dt = K (J - exp u), J = (I + eps) / eps: w = exp(-u) goes toward 1 / J at the rate K J. The level goes from where
/// it was when the pattern began to u: level = u + (start - u) exp(-A t), t since then.
struct ReceptorSegment {
  double receptor_rate_hz = 0.0, amplifier_rate_hz = 0.0;
  double duration_s = 0.0, since_pattern_s = 0.0;  ///< the latter from the pattern's begin to the segment's
  std::array<double, kReceptorNodes> time_s = {};  ///< since the segment's begin; the last is its end
  std::array<double, kReceptorNodes> hold = {};    ///< exp(-A t) at these times

  /// `is_ramp`: light changes during the segment.
  ReceptorSegment(double receptor_rate, double amplifier_rate, double duration, double since_pattern, bool is_ramp);
};

/// w at the end of a time in which J goes linearly from `from` to `to`: what is left of w at its begin, and what the
/// equation dw/dt = K (1 - J w) added since. Exact where J stays; else the latter is right to first order in the
/// curvature of the integral of K J, so the time must be short.
inline double follow_light(double inverse, double from, double to, double receptor_rate_hz, double time_s) {
  const double decay = std::exp(-receptor_rate_hz * 0.5 * (from + to) * time_s);
  if (from == to) return 1.0 / to + (inverse - 1.0 / to) * decay;
  const double x = receptor_rate_hz * to * time_s, e = std::exp(-x);
  constexpr double kSmall = 1e-3;  // where the difference would lose its digits
  const double curvature = x < kSmall ? x * x * x / 3 : 2.0 - e * (x * (x + 2.0) + 2.0);
  const double share = (to - from) / time_s / (2 * receptor_rate_hz * to * to) * curvature / (1.0 - e);
  const double added = (1.0 - e) / to;
  return inverse * decay + (share > 0 ? added * (1.0 + share) : added / (1.0 - share));
}

/// Consecutive pixels. Arrays hold kReceptorBlock values for each node.
inline constexpr size_t kReceptorBlock = 256;
struct ReceptorBlock {
  const double* from = nullptr;   ///< J at the segment's begin
  const double* to = nullptr;     ///< and at its end
  const double* start = nullptr;  ///< the level when the pattern began
  double* inverse = nullptr;      ///< w [node][pixel]; that of node 0 is given
  double* level = nullptr;        ///< [node][pixel]
};

/// Computes w and level at each node for the first `count` pixels; entries up to the next vector length are
/// overwritten, too. Within a few units in the last place of the reference.
void receptor_nodes(const ReceptorSegment& segment, const ReceptorBlock& block, size_t count);
void reference_receptor_nodes(const ReceptorSegment& segment, const ReceptorBlock& block, size_t count);

}  // namespace e2lf::streams
