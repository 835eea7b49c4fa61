// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/profile/sensor_constants.h"
#include "e2lf/model/model.h"

namespace e2lf::recon {

/// A network's input: float32 [channel, y, x], row-major.
struct InputPlanes {
  size_t channels = 0, height = 0, width = 0;
  std::vector<float> values;
};

/// How the counts of event images came about.
struct InputConditions {
  capture::SensorConstants constants = {};  ///< eps and tau, for intensities
  std::vector<float> traits = {};           ///< what the network is told of the camera: capture::camera_traits()
  size_t cycles = 1;                        ///< counts are sums over so many cycles of a scene that stands still
};

/// The input channels of `groups` one after another (see model::InputKind; C_k, m and J_k as in invert_events() with
/// `centred`; a camera's channels hold its traits; counts are divided by the number of cycles), with height and width
/// rounded up to multiples of `size_multiple`. The extra rows and columns at the bottom and right repeat the last ones:
/// no events at all would look like a black frame to a network. Fails with kInvalidValue when a group needs constants
/// that are not positive.
/// What `groups` are made of must have been measured; else the contract is broken.
[[nodiscard]] Result<InputPlanes> network_input(const capture::Measurement& measurement,
                                                std::span<const model::InputGroup> groups,
                                                const InputConditions& conditions, size_t size_multiple = 1);

}  // namespace e2lf::recon
