// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "e2lf/base/planes.h"
#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/profile/sensor_constants.h"
#include "e2lf/model/model.h"

namespace e2lf::recon {

/// The input of a network: float32 [channel, y, x], row-major.
using InputPlanes = Planes<float>;

/// The conditions under which the counts of event images were recorded.
struct InputConditions {
  capture::SensorConstants constants = {};  ///< eps and tau are used for intensities
  std::vector<float> conditioning = {};     ///< the conditioning vector capture::conditioning_vector()
  size_t cycles = 1;                        ///< number of cycles of a static scene over which counts are summed
};

/// Makes the input channels of `groups`, one group after another (see model::InputKind; C_k, m and J_k as in
/// invert_events() with `centred`). The channels of a camera hold its conditioning vector, and counts are divided by
/// the number of cycles. Height and width are rounded up to multiples of `size_multiple`. The additional rows and
/// columns at the bottom and right repeat the last ones, because the absence of events would look like a black frame to
/// a network. Fails with kInvalidValue if a group needs constants that are not positive. If `measurement` lacks the
/// data for a group, the contract is broken.
[[nodiscard]] Result<InputPlanes> network_input(const capture::Measurement& measurement,
                                                std::span<const model::InputGroup> groups,
                                                const InputConditions& conditions, size_t size_multiple = 1);

/// Computes the same input in `planes`, whose memory is reused.
[[nodiscard]] Result<void> network_input(const capture::Measurement& measurement,
                                         std::span<const model::InputGroup> groups, const InputConditions& conditions,
                                         size_t size_multiple, InputPlanes& planes);

}  // namespace e2lf::recon
