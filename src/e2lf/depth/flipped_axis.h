// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/base/result.h"
#include "e2lf/depth/disparity.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::depth {

/// Whether the views are flipped along one axis, left and right or upper and lower.
enum class FlippedAxis { kNone, kX, kY, kEither };

/// Finds whether the views are flipped along one axis. The disparities of a point then have opposite signs along the
/// two axes, so that no depth fits all views, but one fits if an axis is flipped. `map` must belong to this light
/// field. Its confidence is looked at first; only if it is low, the middle 256x256 px are estimated twice. The axis
/// follows from occlusion_sign(), and is kEither if that is undecided. Fails as estimate_disparity() does.
[[nodiscard]] Result<FlippedAxis> find_flipped_axis(const lightfield::LightField& light_field, const DisparityMap& map);

/// Returns the mean confidence of a map, in [0, 1].
[[nodiscard]] double mean_confidence(const DisparityMap& map);

}  // namespace e2lf::depth
