// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "e2lf/recordings/codecs/dat/dat_header.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::dat {

/// Prophesee DAT: a text header, a byte each for record type and size, then 8-byte records: u32 time in us, u32 place.
/// Times wrap after 71.6 minutes; the reader unwraps them, so gaps between records must stay below 17 minutes there.
/// Seeking goes by the times of a few records (dat_seek.h).
/// Triggers are in a second file: name_cd.dat or name.dat has name_trigger.dat, read when it is there.

[[nodiscard]] bool detect(std::span<const uint8_t> head);
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open(std::unique_ptr<ByteSource> source,
                                                            const OpenOptions& options);

/// Writes version 2 with the time unwrapped from its low 32 bits: the first event must be before 2^32 us (kInvalidValue
/// otherwise; shift the recording to zero). Into a sink only events go; into a file, triggers go to their own file.
[[nodiscard]] Result<std::unique_ptr<RecordingWriter>> create(std::unique_ptr<ByteSink> sink,
                                                              const RecordingInfo& info);
[[nodiscard]] Result<std::unique_ptr<RecordingWriter>> create_file(const std::filesystem::path& path,
                                                                   const RecordingInfo& info);

/// name_trigger.dat for name_cd.dat or name.dat.
[[nodiscard]] std::filesystem::path trigger_path(const std::filesystem::path& path);

/// Whether a file begins as a name_trigger.dat does, and not as one of events.
[[nodiscard]] bool is_trigger_file(const std::filesystem::path& path);

}  // namespace e2lf::recordings::dat
