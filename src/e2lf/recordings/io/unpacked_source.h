// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <span>

#include "e2lf/recordings/io/byte_source.h"

namespace e2lf::recordings {

/// Number of bytes that determine whether a file is compressed.
inline constexpr size_t kPackedMarkBytes = 4;

/// Returns whether bytes begin like a file that was compressed with gzip or Zstandard.
[[nodiscard]] bool is_packed(std::span<const uint8_t> head);

/// Returns the decompressed content of a source for which is_packed() is true. It is decompressed while it is read;
/// memory is bounded by the size of the requests and by the 128 MiB that Zstandard may look back. Files of several
/// parts are read to their end. The result is not seekable. If the compressed data are damaged or incomplete, the
/// content ends there, which is counted in `losses` with positions in the compressed file. Fails with
/// kMissingDependency (Zstandard in a build without it).
[[nodiscard]] Result<SourcePtr> make_unpacked_source(SourcePtr packed, std::shared_ptr<DecodeSummary> losses);

/// Opens a file beside a recording, with its name or with ".gz" or ".zst" appended. Returns null if there is none.
[[nodiscard]] Result<SourcePtr> open_file_beside(const std::filesystem::path& path);

}  // namespace e2lf::recordings
