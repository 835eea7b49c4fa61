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

/// Opens a recording from its beginning, several times.
struct RecordingSource {
  /// Opens it for a sensor of this size if the recording does not state one; 0 = as stated.
  std::function<Result<std::unique_ptr<recordings::RecordingReader>>(size_t width, size_t height)> open;
  /// Opens its cycles; `on_batch` is called with everything that is read. If empty, no cycles are searched.
  std::function<Result<cycles::CycleReader>(const std::function<void(const recordings::EventBatch&)>& on_batch)>
      open_cycles;
};

/// Adds a recording as at most `num_frames` (>= 1) images of events accumulated over equal intervals, with its event
/// rate, its triggers and the cycles found in it (none if they cannot be determined). It is read twice, or three times
/// if the search for cycles ends early. Times are relative to the first event or trigger. Fails as the reader does, and
/// with kInvalidValue if there are no events.
[[nodiscard]] Result<void> add_recording(Document& document, const std::string& name, const RecordingSource& source,
                                         size_t num_frames);

}  // namespace e2lf::view
