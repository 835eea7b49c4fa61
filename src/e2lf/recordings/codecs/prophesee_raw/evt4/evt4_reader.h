// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/recordings/io/byte_source.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::evt4 {

/// Returns a reader of the EVT4 words at which the source stands; `info` is what the header said. The clock of 34 bits
/// goes on where it wraps, after 4 h 46 min, as where it starts again (continued_clock.h).
[[nodiscard]] std::unique_ptr<RecordingReader> make_reader(std::unique_ptr<ByteSource> source, RecordingInfo info,
                                                           const OpenOptions& options);

}  // namespace e2lf::recordings::evt4
