// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/sensor/event_model.h"

namespace e2lf::recon {

/// Measures how accurately two findings of the paper hold for one setting of a sensor. The means are taken over pixels
/// and patterns, or over pixels and transitions.
struct Equivalence {
  double intensity_error = 0;  ///< of Eq. 7: root mean square error of the coded intensities of the patterns other than
                               ///< black, relative to their root mean square
  double centred_error = 0;    ///< the same with half a threshold added; see InversionOptions::centred
  double permuted_error = 0;   ///< of Eq. 11: root mean square difference, in events, between the event images of the
                               ///< reordered patterns and those computed from the first order
  double repeated_error = 0;   ///< the same between two recordings of the other order, which is due to noise alone
  double events_per_pixel = 0;  ///< value for the first order
  double permuted_events_per_pixel = 0;
};

/// Simulates the event images of `codes` and of the same patterns in the order `order` (Eq. 8 to 10), and compares
/// them. One pattern must be black. `order` must contain each of 0 .. N - 1 once. Fails with kInvalidValue if no
/// pattern is black, and as simulate_events() does.
[[nodiscard]] Result<Equivalence> measure_equivalence(const capture::Codes& codes, const std::vector<size_t>& order,
                                                      const lightfield::LightField& scene,
                                                      const sensor::EventModelOptions& options);

}  // namespace e2lf::recon
