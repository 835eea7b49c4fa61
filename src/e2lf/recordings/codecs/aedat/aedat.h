// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <span>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::aedat {

/// The older AEDAT formats. Both begin with lines of text; AEDAT 4 is another format (codecs/aedat4).
///
/// AEDAT 2 (jAER): records of a 32-bit address and a 32-bit time in us, big-endian. What the bits of an address mean
/// depends on the camera, which the header may name ("# AEChip: ...Davis240C"): a DVS128, or one of the DAVIS cameras.
/// Where it does not, the first addresses tell the kind of camera. jAER counts rows from the bottom and columns of the
/// address from the right; events come out counted from the top left. External input is trigger 0; a pulse counts as a
/// rising edge. Frames and inertial data are passed over.
///
/// AEDAT 3 (cAER): packets of events of one type and one source, little-endian. Polarity and special events are read.
/// Triggers: external inputs 0, 1 and 2; 3 is the generator; a pulse counts as a rising edge. Several sources are
/// several streams. Rows of AEDAT 3.0 count from the bottom, those of 3.1 from the top.
///
/// AEDAT 2 cannot be sought quickly: seeking reads from the start.

[[nodiscard]] bool detect_aedat2(std::span<const uint8_t> head);
[[nodiscard]] bool detect_aedat3(std::span<const uint8_t> head);

/// Fails with kFormat (no such header) and kInvalidValue (a size that contradicts the header).
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_aedat2(std::unique_ptr<ByteSource> source,
                                                                   const OpenOptions& options);

/// Fails with kFormat (no such header), kUnsupported (packed packets) and kInvalidValue (no stream of that name).
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_aedat3(std::unique_ptr<ByteSource> source,
                                                                   const OpenOptions& options);

}  // namespace e2lf::recordings::aedat
