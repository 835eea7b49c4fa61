// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <span>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::aedat4 {

/// iniVation AEDAT 4: a version line, a FlatBuffer header, then packets (i32 stream, i32 size, compressed FlatBuffer).
/// Events of one event stream are read, of the lowest where options.stream names no other, and triggers of all trigger
/// streams, or where there are several cameras of those of its camera; packets of other event and trigger streams are
/// counted as left out where no stream was named. Frames and inertial data are passed over. Trigger id 0 = the external
/// input, 1 = the generator; a pulse counts as a rising edge; resets and frame marks are not triggers. LZ4 and no
/// compression always, Zstd where the build has it. The table at the file's end is not needed; seeking goes from packet
/// to packet without unpacking them.

[[nodiscard]] bool detect(std::span<const uint8_t> head);

/// Fails with kFormat and kTruncated (header), kUnsupported (an unknown compression), kMissingDependency (Zstd) and
/// kInvalidValue (no stream of that name).
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open(std::unique_ptr<ByteSource> source,
                                                            const OpenOptions& options);

}  // namespace e2lf::recordings::aedat4
