// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/model/model.h"
#include "e2lf/model/video/video_model.h"

namespace e2lf::model {

/// What a model is, for `e2lf model info --json`: name, patterns, views, event model, constants, input, network figures
/// (layers, parameters, multiply-adds per pixel, receptive field in pixels), light efficiency of its codes (null when
/// it has none), provenance. The model must pass validate().
[[nodiscard]] Json summary_json(const Model& model);

/// The same for people, with a picture of the patterns.
[[nodiscard]] std::string summary_text(const Model& model);

/// The same of a model that makes frames: name, measurement, bins, what happens to voxels and frames, network figures,
/// provenance.
[[nodiscard]] Json summary_json(const VideoModel& model);
[[nodiscard]] std::string summary_text(const VideoModel& model);

}  // namespace e2lf::model
