// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/light_field.h"

/// Scenes that move before the camera, and how well a light field matches one of them.
namespace e2lf::bench {

/// The largest motion within two cycles that a scene has room for, px.
constexpr size_t kMostMotionPx = 16;

/// Returns the middle rows of a scene, and its columns after it moved to the left by `motion_px`, which is at most
/// kMostMotionPx. The result has at most size x size pixels. Fails with kShape if the scene is narrower than
/// kMostMotionPx + 17 px.
[[nodiscard]] Result<lightfield::LightField> in_view(const lightfield::LightField& scene, size_t size,
                                                     size_t motion_px);

/// Returns the largest PSNR of a light field against these scenes, dB. It is scaled by its least-squares factor for
/// each, so that a network that was trained for another camera does not lose by brightness alone. Fails with kShape.
[[nodiscard]] Result<double> best_psnr_db(const lightfield::LightField& field,
                                          const std::vector<lightfield::LightField>& scenes);

}  // namespace e2lf::bench
