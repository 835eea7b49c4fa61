// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/model/model.h"

namespace e2lf::pipeline {

/// A simulated camera whose events are accumulated per transition.
struct SimulatedCamera {
  capture::MeasurementKind measurement = capture::MeasurementKind::kEventImages;
  capture::Codes codes;
  capture::SensorProfile profile = {};  ///< physical pixels, or an event model of the paper with its constants
  float gain = 1.0F, residue = 0.0F;    ///< see sensor::EventModelOptions; physical pixels ignore the residue
  uint64_t seed = 1;
};

/// Simulates the measurement of one cycle of a static scene: event images, intensity images or both. The seed of its
/// noise is that of the camera plus `cycle`; the thresholds of physical pixels do not change from cycle to cycle. Fails
/// as sensor::simulate_events(), sensor::simulate_pixel_events() and sensor::measure_images() do.
[[nodiscard]] Result<capture::Measurement> simulate_cycle(const SimulatedCamera& camera,
                                                          const lightfield::LightField& scene, uint64_t cycle);

/// Measures what a network loses on `scenes` in each arithmetic that this CPU supports; the others are
/// absent. The camera that the model was trained for is simulated. The loss is that of the mean squared error over all
/// scenes: of the views, or, for a network for disparity, of the disparities that depth::true_disparity() finds. Fails
/// with kInvalidValue if the model has no codes, and as simulate_cycle() and recon::Reconstructor do.
[[nodiscard]] Result<model::PrecisionLoss> measure_precision_loss(const model::Model& model,
                                                                  std::span<const lightfield::LightField> scenes);

}  // namespace e2lf::pipeline
