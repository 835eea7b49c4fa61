// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <span>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::aedat {

/// The older AEDAT formats. Both begin with lines of text; AEDAT 4 is a different format (codecs/aedat4).
///
/// AEDAT 2 (jAER): big-endian records of a 32-bit address and a 32-bit time in us. The meaning of the bits of an
/// address depends on the camera, a DVS128 or one of the DAVIS cameras, which the header may name ("# AEChip:
/// ...Davis240C"); otherwise, the first addresses determine the kind. jAER counts rows from the bottom and the columns
/// of the address from the right; the events that are returned are counted from the top left. The external input is
/// trigger 0, and a pulse counts as a rising edge. Frames and inertial data are skipped.
///
/// AEDAT 3 (cAER): little-endian packets of events of one type and source. Polarity and special events are read.
/// Triggers 0, 1 and 2 are the external inputs, and 3 is the generator; a pulse counts as a rising edge. Several
/// sources are several streams. Rows of AEDAT 3.0 are counted from the bottom, those of 3.1 from the top.
///
/// AEDAT 2 does not support fast seeking: a seek reads from the start.

[[nodiscard]] bool detect_aedat2(std::span<const uint8_t> head);
[[nodiscard]] bool detect_aedat3(std::span<const uint8_t> head);

/// Opens an AEDAT 2 recording. Fails with kFormat (no such header) and kInvalidValue (a size that contradicts the
/// header).
[[nodiscard]] Result<ReaderPtr> open_aedat2(SourcePtr source, const OpenOptions& options);

/// Opens an AEDAT 3 recording. Fails with kFormat (no such header), kUnsupported (compressed packets) and kInvalidValue
/// (no stream with this name).
[[nodiscard]] Result<ReaderPtr> open_aedat3(SourcePtr source, const OpenOptions& options);

}  // namespace e2lf::recordings::aedat
