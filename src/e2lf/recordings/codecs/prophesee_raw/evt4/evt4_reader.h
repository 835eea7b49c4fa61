// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/recordings/io/byte_source.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::evt4 {

/// Returns a reader of EVT4 words, which begin at the position of the source; `info` contains the header. Times
/// continue where the 34-bit clock wraps around, after 4 h 46 min, and where it starts again (make_continued()).
[[nodiscard]] ReaderPtr make_reader(SourcePtr source, RecordingInfo info, const OpenOptions& options);

}  // namespace e2lf::recordings::evt4
