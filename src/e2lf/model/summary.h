// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/model/model.h"
#include "e2lf/model/video/video_model.h"

namespace e2lf::model {

/// Summarises a model for `e2lf model info --json`: name, patterns, views, event model, constants, input, figures of
/// the network (layers, parameters, multiply-adds per pixel, receptive field in pixels), light efficiency of its codes
/// (null if it has none) and provenance. The model must pass validate().
[[nodiscard]] Json summary_json(const Model& model);

/// Summarises a model as text, with a picture of the patterns.
[[nodiscard]] std::string summary_text(const Model& model);

/// Summarises a model that makes frames: name, measurement, bins, treatment of voxels and frames, figures of the
/// network and provenance.
[[nodiscard]] Json summary_json(const VideoModel& model);
[[nodiscard]] std::string summary_text(const VideoModel& model);

}  // namespace e2lf::model
