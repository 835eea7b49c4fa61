// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "e2lf/aperture/coded_intensities.h"
#include "e2lf/aperture/sensor_constants.h"
#include "e2lf/base/result.h"
#include "e2lf/events/event_images.h"

namespace e2lf::recon {

struct InversionOptions {
  size_t black = 0;  ///< number n_B of the black pattern, from 0
  aperture::SensorConstants constants = {};
  bool centred = false;  ///< see invert_events()
};

/// The coded intensities of N patterns from N - 1 event images in closed form (Eq. 7), for patterns before and after
/// the black one: I_n = eps (exp(tau C_n) - 1), where C_n is the sum of the events from pattern n_B to pattern n, with
/// the opposite sign when n < n_B. Noise can make values negative; very large counts are limited to keep them finite.
///
/// Counting truncates toward zero, so a pixel's log intensity lies up to one threshold beyond its counted level on the
/// side of its last change. `centred` adds half a threshold on that side: C_n + (s_n - s_B) / 2 in place of C_n, where
/// s_k is the sign of the last nonzero count up to pattern k, 0 before the first.
///
/// Fails with kInvalidValue (eps or tau not positive, no such pattern n_B).
[[nodiscard]] Result<aperture::CodedIntensities> invert_events(const events::EventImages& images,
                                                               const InversionOptions& options);

}  // namespace e2lf::recon
