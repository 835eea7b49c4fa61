// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/capture/profile/camera.h"
#include "e2lf/streams/stream_options.h"

namespace e2lf::streams {

/// The stream of a camera file: its model with its constants. `seed` is of a capture; pixels get maps of their own.
[[nodiscard]] StreamOptions camera_stream(const capture::Camera& camera, uint64_t seed);

}  // namespace e2lf::streams
