// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "e2lf/video/video_model.h"

namespace e2lf::video {

/// Returns the quantile `share` (0 to 1) of the values, with linear interpolation between the sorted values at share (n
/// - 1), like numpy's percentile(). There must be at least one value and no NaN. The values are reordered.
[[nodiscard]] float quantile(std::span<float> values, double share);

/// Maps a frame to its range (see FrameTone) and clamps it to [0, 1]. A constant frame becomes 0 if the tone
/// uses quantiles.
void apply_frame_tone(FrameTone tone, std::span<float> frame);

}  // namespace e2lf::video
