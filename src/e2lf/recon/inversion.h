// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/profile/sensor_profile.h"

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

}  // namespace e2lf::recon
