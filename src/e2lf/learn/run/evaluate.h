// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "e2lf/learn/data/dataset.h"
#include "e2lf/learn/events/event_simulation.h"
#include "e2lf/learn/network/network_module.h"
#include "e2lf/learn/run/run_log.h"

namespace e2lf::learn {

/// The codes, sensor and network that convert a light field to a measurement and reconstruct it.
struct Pipeline {
  const NetworkModule* network = nullptr;
  const NamedTensors* weights = nullptr;
  torch::Tensor codes;  ///< [N, 64]
  EventModel event_model = EventModel::kReferenceAware;
  std::vector<model::InputGroup> input;
  torch::ScalarType compute = torch::kFloat;
  NamedTensors* input_means = nullptr;  ///< see NetworkModule::forward
  double image_sigma = 0.0;             ///< standard deviation of the noise of intensity images

  /// Returns the measurement that `input` requires.
  [[nodiscard]] capture::MeasurementKind measurement() const { return model::measurement_of(input).value(); }
};

/// The measurement of light fields [batch, 64, y, x], and their reconstruction.
struct Reconstruction {
  torch::Tensor events;       ///< [batch, transitions, y, x], or [batch, 0, y, x] for a measurement without events
  torch::Tensor light_field;  ///< float32 [batch, 64, y, x]
};
[[nodiscard]] Reconstruction reconstruct(const Pipeline& pipeline, const torch::Tensor& light_field,
                                         const SampleConstants& constants, const SensorNoise& noise,
                                         const MovingSamples& moving = {});

/// Simulates and reconstructs a whole scene with one sample of constants. Its right and lower edges are cropped to a
/// multiple of 16 px. The noise depends only on `seed`, with which torch's generator is reseeded.
[[nodiscard]] SceneScore evaluate_scene(const Pipeline& pipeline, const Scene& scene, const SampleConstants& constants,
                                        uint64_t seed);

}  // namespace e2lf::learn
