// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "e2lf/recordings/codecs/dat/dat_header.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::dat {

/// Prophesee DAT: a text header, one byte each for the type and the size of records, then 8-byte records (u32 time in
/// us, u32 coordinates and polarity). Times wrap around after 71.6 minutes; the reader unwraps them, which requires
/// gaps between records of less than 17 minutes. Seeking uses the times of a few records (dat_seek.h). Triggers are
/// stored in a second file: name_trigger.dat for name_cd.dat or name.dat, which is read if it exists.

[[nodiscard]] bool detect(std::span<const uint8_t> head);
[[nodiscard]] Result<ReaderPtr> open(SourcePtr source, const OpenOptions& options);

/// Writes version 2 with the low 32 bits of the times. The first event must be before 2^32 us; otherwise writing fails
/// with kInvalidValue, and the recording must be shifted to zero. A sink only receives events; if the recording is a
/// file, triggers are written to a second one.
[[nodiscard]] Result<WriterPtr> create(SinkPtr sink, const RecordingInfo& info);
[[nodiscard]] Result<WriterPtr> create_file(const std::filesystem::path& path, const RecordingInfo& info);

/// Returns name_trigger.dat for name_cd.dat or name.dat.
[[nodiscard]] std::filesystem::path trigger_path(const std::filesystem::path& path);

/// Returns whether a file begins like a name_trigger.dat and not like a file of events.
[[nodiscard]] bool is_trigger_file(const std::filesystem::path& path);

}  // namespace e2lf::recordings::dat
