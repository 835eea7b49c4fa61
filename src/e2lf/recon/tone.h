// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "e2lf/model/video/video_model.h"

namespace e2lf::recon {

/// The quantile `share` (0 to 1) of values, with linear interpolation between the sorted values at share (n - 1), as
/// numpy's percentile() does. There must be a value, and no NaN. The values are put in another order.
[[nodiscard]] float quantile(std::span<float> values, double share);

/// Brings a frame to its range (see model::Tone) and clamps it to [0, 1]. A frame of one value becomes 0 where
/// quantiles are asked for.
void apply_tone(model::Tone tone, std::span<float> frame);

}  // namespace e2lf::recon
