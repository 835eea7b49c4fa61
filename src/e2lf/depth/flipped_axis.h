// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/base/result.h"
#include "e2lf/depth/disparity.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::depth {

/// The axis along which the views are flipped: left and right, or upper and lower.
enum class FlippedAxis { kNone, kX, kY, kEither };

/// Determines whether the views are flipped along one axis. In this case, the disparities of a point have opposite
/// signs along the two axes, so that no depth fits all views until an axis is flipped. `map` must belong to this light
/// field. Only if its confidence is low, the middle 256x256 px are estimated twice. The axis follows from
/// occlusion_sign(), and is kEither if that is undecided. Fails as estimate_disparity() does.
[[nodiscard]] Result<FlippedAxis> find_flipped_axis(const lightfield::LightField& light_field, const DisparityMap& map);

/// Returns the mean confidence of a map, in [0, 1].
[[nodiscard]] double mean_confidence(const DisparityMap& map);

}  // namespace e2lf::depth
