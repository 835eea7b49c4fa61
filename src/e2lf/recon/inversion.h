// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/coded_intensities.h"
#include "e2lf/capture/measurement/event_images.h"
#include "e2lf/capture/profile/sensor_constants.h"

namespace e2lf::recon {

struct InversionOptions {
  size_t black = 0;  ///< the number n_B of the black pattern, counted from 0
  capture::SensorConstants constants = {};
  bool centred = false;  ///< see invert_events()
};

/// Computes the coded intensities of N patterns from N - 1 event images in closed form (Eq. 7), for patterns before and
/// after the black one: I_n = eps (exp(tau C_n) - 1), where C_n is the sum of the events from pattern n_B to pattern n,
/// with the opposite sign if n < n_B. Noise can make values negative. Very large counts are limited so that values stay
/// finite.
///
/// Counting truncates toward zero, so the log intensity of a pixel lies up to one threshold beyond its counted level,
/// on the side of its last change. `centred` adds half a threshold on that side: it uses C_n + (s_n - s_B) / 2 instead
/// of C_n, where s_k is the sign of the last non-zero count up to pattern k, and 0 before the first.
///
/// Fails with kInvalidValue (eps or tau not positive, or no pattern n_B).
[[nodiscard]] Result<capture::CodedIntensities> invert_events(const capture::EventImages& images,
                                                              const InversionOptions& options);

/// The closed interval of each coded intensity that is consistent with its counts.
struct IntensityBounds {
  capture::CodedIntensities lower, upper;
};

enum class Counting { kQuantised, kReferenceAware };  ///< Eq. 8; Eq. 9 and 10

/// Computes the intervals for noise-free events (options.centred is ignored). In thresholds, a count e leaves a
/// residual R(e) = [0, 1] for e > 0, [-1, 0] for e < 0, [-1, 1] for e = 0. With l_n = ln(I_n + eps), l_B = ln(eps):
///   reference-aware: (l_n - l_B) / tau in C_n + R(E_n) - R(E_B), and R = 0 for the first pattern, where the reference
///                    starts;
///   quantised:       (l_n - l_B) / tau in the sum of E_k + R(E_k) over the transitions k between n_B and n, with the
///                    opposite sign if n < n_B.
/// Intensities are never negative, so the intervals are cut at 0. Fails as invert_events() does.
[[nodiscard]] Result<IntensityBounds> intensity_bounds(const capture::EventImages& images,
                                                       const InversionOptions& options, Counting counting);

/// Computes the virtual event images of the same patterns shown in another order (Eq. 11): image i leads from pattern
/// order[i] to pattern order[i + 1]. `order` must contain each of 0 .. N - 1 once, or the contract is broken. Sums
/// beyond int16 are saturated.
[[nodiscard]] capture::EventImages permute_events(const capture::EventImages& images, std::span<const size_t> order);

}  // namespace e2lf::recon
