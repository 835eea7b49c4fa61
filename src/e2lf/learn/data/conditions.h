// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>

#include "e2lf/capture/patterns/codes.h"
#include "e2lf/learn/data/draws.h"
#include "e2lf/learn/events/event_simulation.h"
#include "e2lf/learn/run/config.h"

namespace e2lf::learn {

/// The light and the sensor of each sample of a batch.
struct Conditions {
  torch::Tensor gain;     ///< brightness of the scenes, float32 [batch]
  torch::Tensor residue;  ///< the upper limit of the residual reference offset, in thresholds, float32 [batch]
  SampleConstants constants;
};

/// The numbers of patterns that are shown, and of codes among them, which differ for a whole cycle.
struct PatternNumbers {
  size_t all = 0, codes = 0;
};

/// Returns those of a sequence of patterns.
[[nodiscard]] inline PatternNumbers numbers_of(const capture::Codes& codes) {
  const auto lit = capture::codes_of_whole_cycle(codes);
  return {codes.num_patterns, lit ? lit->num_patterns : codes.num_patterns};
}

/// Draws the conditions of the paper's models from the ranges of a configuration.
[[nodiscard]] Conditions draw_conditions(const SensorConfig& sensor, uint64_t batch, torch::Device device,
                                         Draws& draws);

/// Sets the conditioning vectors of the paper's models; apply_camera() replaces those of physical pixels. A single
/// pattern has no events and no conditioning.
void add_conditioning(size_t num_patterns, Conditions& conditions);

/// Replaces a share of the samples by samples of the camera, whose constants are drawn from their uncertainties.
void apply_camera(const SensorConfig& sensor, const capture::SensorProfile& camera, const PatternNumbers& patterns,
                  size_t cycles, Draws& draws, Conditions& conditions);

}  // namespace e2lf::learn
