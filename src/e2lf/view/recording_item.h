// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/recordings/recording.h"
#include "e2lf/view/document.h"

namespace e2lf::view {

/// How a recording is opened, each time from its beginning.
struct RecordingSource {
  /// For a sensor of that size where the recording does not say; 0 = as it says.
  std::function<Result<std::unique_ptr<recordings::RecordingReader>>(size_t width, size_t height)> open;
  std::function<Result<cycles::CycleReader>()> open_cycles;  ///< may be empty: cycles are not looked for
};

/// Adds a recording as at most `num_frames` (>= 1) images of accumulated events over equal stretches of time, with its
/// event rate, its triggers and the cycles that are found in it (none where they cannot be told). It is read three
/// times. Times are shifted to 0 = the first event or trigger. Fails as the reader does, with kInvalidValue where it
/// holds no events.
[[nodiscard]] Result<void> add_recording(Document& document, const std::string& name, const RecordingSource& source,
                                         size_t num_frames);

}  // namespace e2lf::view
