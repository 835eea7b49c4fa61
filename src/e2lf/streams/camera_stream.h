// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/streams/stream_options.h"

namespace e2lf::streams {

/// Returns the stream options for a camera file: its event model and constants. `seed` identifies a capture and also
/// selects the map of pixel properties.
[[nodiscard]] StreamOptions camera_stream(const capture::SensorProfile& camera, uint64_t seed);

}  // namespace e2lf::streams
