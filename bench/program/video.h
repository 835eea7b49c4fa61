// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/files/options.h"
#include "e2lf/video/video_model.h"

namespace e2lf::bench {

struct VideoBench {
  size_t width = 640, height = 480;
  size_t frames = 5;                       ///< timed frames of each network, after one that warms up
  std::optional<video::VideoModel> model;  ///< empty: FireNet, E2VID's U-Net and ET-Net with random weights
};

/// Measures the time per frame of recurrent networks in float32 and, if the CPU supports it, bfloat16, relative to
/// libtorch in float32 on the same input, and the largest difference of the last frame between both in float32. Sizes
/// are rounded up to multiples that the networks accept.
[[nodiscard]] Result<Json> bench_video(const VideoBench& options, const ProgressFn& progress);

}  // namespace e2lf::bench
