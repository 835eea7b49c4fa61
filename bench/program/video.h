// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/files/options.h"
#include "e2lf/model/video/video_model.h"

namespace e2lf::bench {

struct VideoBench {
  size_t width = 640, height = 480;
  size_t frames = 5;                       ///< that are timed, of each; one more warms up
  std::optional<model::VideoModel> model;  ///< empty: FireNet, E2VID's U-Net and ET-Net with random weights
  std::filesystem::path peer_module;       ///< empty: beside the program
};

/// Frames of recurrent networks in float32 and, where the CPU has it, bfloat16, against libtorch in float32 on the same
/// input; the ratio, and the largest difference of the last frame between both in float32. Sizes are made multiples of
/// what the networks need.
[[nodiscard]] Result<Json> bench_video(const VideoBench& options, const ProgressFn& progress);

}  // namespace e2lf::bench
