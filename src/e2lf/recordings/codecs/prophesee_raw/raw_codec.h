// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings {

/// Opens a Prophesee RAW recording: EVT2, EVT2.1 (either byte order), EVT3 or EVT4, as its header or options.format
/// states.
[[nodiscard]] Result<ReaderPtr> open_raw(SourcePtr source, const OpenOptions& options);

/// Creates a RAW recording in info.format, or in EVT3 if that is not a RAW encoding.
[[nodiscard]] Result<WriterPtr> create_raw(SinkPtr sink, const RecordingInfo& info);

}  // namespace e2lf::recordings
