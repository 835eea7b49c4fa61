// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "e2lf/learn/data/dataset.h"
#include "e2lf/learn/events/event_simulation.h"
#include "e2lf/learn/network/network_module.h"

namespace e2lf::learn {

/// Codes, sensor and network that turn a light field into a measurement and back.
struct Pipeline {
  const NetworkModule* network = nullptr;
  const NamedTensors* weights = nullptr;
  torch::Tensor codes;  ///< [N, 64]
  EventModel event_model = EventModel::kReferenceAware;
  std::vector<model::InputGroup> input;
  torch::ScalarType compute = torch::kFloat;
  NamedTensors* input_means = nullptr;  ///< see NetworkModule::forward
  double image_sigma = 0.0;             ///< noise of intensity images

  /// What `input` needs.
  [[nodiscard]] capture::MeasurementKind measurement() const { return model::measurement_of(input).value(); }
};

/// What is measured of light fields [batch, 64, y, x] and what the network makes of it, of the same shape.
struct Reconstruction {
  torch::Tensor events;       ///< [batch, N - 1, y, x]; of a measurement without events [batch, 0, y, x]
  torch::Tensor light_field;  ///< float32 [batch, 64, y, x]
};
[[nodiscard]] Reconstruction reconstruct(const Pipeline& pipeline, const torch::Tensor& light_field,
                                         const SampleConstants& constants, const SensorNoise& noise);

struct SceneScore {
  std::string name;
  double psnr_db = 0;  ///< mean over the views, output clamped to [0, 1]
  double events_per_pixel = 0;
};

/// Simulates and reconstructs a whole scene with one sample of constants. Its right and lower edges are cut to a
/// multiple of 16 px. The noise depends on `seed` alone, with which torch's generator is reseeded.
[[nodiscard]] SceneScore evaluate_scene(const Pipeline& pipeline, const Scene& scene, const SampleConstants& constants,
                                        uint64_t seed);

}  // namespace e2lf::learn
