// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/recordings/io/byte_source.h"
#include "e2lf/recordings/live/camera.h"
#include "e2lf/recordings/live/replay_address.h"

namespace e2lf::recordings {

/// Returns true if a source begins with the header of a RAW recording in EVT3. Fails as ByteSource::fetch() does.
[[nodiscard]] Result<bool> is_evt3_recording(ByteSource& source);

/// Makes a camera that delivers the bytes of a RAW recording in EVT3 as they are, each when its time has come. A step
/// of the clock by more than a quarter of a second, where data is missing or damaged, takes no time. When it is played
/// again, the clock continues, and its TIME_HIGH words are shifted. `source` must then be seekable.
[[nodiscard]] CameraPtr make_raw_replay(SourcePtr source, const ReplayAddress& replay);

}  // namespace e2lf::recordings
