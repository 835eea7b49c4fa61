// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <torch/types.h>
#include <vector>

#include "e2lf/capture/patterns/codes.h"
#include "e2lf/learn/data/dataset.h"
#include "e2lf/learn/events/event_simulation.h"
#include "e2lf/learn/run/task.h"

/// How networks for any patterns are judged.
namespace e2lf::learn {

/// A set of patterns with which a network is judged, and its name, which is empty for patterns.codes.
struct JudgedSet {
  std::string name;
  capture::Codes codes;
};

/// Reads a set of patterns as the display shows it: whole cycles if patterns.whole_cycle is set. Fails as
/// read_pattern_set() and describe_apertures() do.
[[nodiscard]] Result<capture::Codes> read_shown(const std::string& name, const PatternConfig& patterns);

/// Reads the patterns that a network is judged with: those of patterns.evaluated, or else `own`.
[[nodiscard]] Result<std::vector<JudgedSet>> read_judged(const PatternConfig& patterns, const capture::Codes& own);

/// Judges a scene with each set by `judge`; the names of the scores are those of the scene and the set.
[[nodiscard]] Result<std::vector<SceneScore>> judge_sets(
    const std::vector<JudgedSet>& sets, const std::function<Result<SceneScore>(const capture::Codes&)>& judge);

/// The events of one scene as a batch, continued by mirror images to a size that networks take.
struct JudgedEvents {
  torch::Tensor events, cycles;  ///< as those of DepthBatch
  SampleConstants constants;
  double events_per_pixel = 0;
};

/// Simulates the events of a scene. The size becomes a multiple of `multiple`. Fails with kShape if the scene is too
/// small for it.
[[nodiscard]] Result<JudgedEvents> simulate_judged(const Scene& scene, const capture::Codes& codes,
                                                   const Judgement& judgement, int64_t multiple, torch::Device device);

/// Takes of a map [y, x] of a judged scene what is inside of the scene and of a border of 15 px.
[[nodiscard]] torch::Tensor judged_part(const torch::Tensor& map, const Scene& scene);

}  // namespace e2lf::learn
