// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <span>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::aedat4 {

/// iniVation AEDAT 4: a version line, a FlatBuffer header, then packets (i32 stream, i32 size, compressed FlatBuffer).
/// The events of one stream are read: the one that options.stream selects, or that with the lowest number. Triggers are
/// those of all trigger streams, or, if there are several cameras, of the same camera. If no stream was selected,
/// packets of other event and trigger streams are counted as left out. Frames and inertial data are skipped. Trigger 0
/// is the external input and 1 the generator; a pulse counts as a rising edge; resets and frame marks are not triggers.
/// LZ4 and uncompressed packets are always supported, Zstd if the build has it. The table at the end of the file is not
/// needed: seeking skips from packet to packet without decompressing them.

[[nodiscard]] bool detect(std::span<const uint8_t> head);

/// Opens an AEDAT 4 recording. Fails with kFormat and kTruncated (header), kUnsupported (an unknown compression),
/// kMissingDependency (Zstd) and kInvalidValue (no stream with this name).
[[nodiscard]] Result<ReaderPtr> open(SourcePtr source, const OpenOptions& options);

}  // namespace e2lf::recordings::aedat4
