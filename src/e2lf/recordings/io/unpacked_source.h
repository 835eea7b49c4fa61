// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <span>

#include "e2lf/recordings/io/byte_source.h"

namespace e2lf::recordings {

/// How many bytes tell whether a file is compressed.
inline constexpr size_t kPackedMarkBytes = 4;

/// Whether bytes begin as a file compressed by gzip or Zstandard does.
[[nodiscard]] bool is_packed(std::span<const uint8_t> head);

/// The contents of a source for which is_packed() holds, unpacked as they are read: memory is bounded by what is asked
/// for, and by 128 MiB that Zstandard may look back. Files of several parts are read to their end. It cannot be sought.
/// Where the packed bytes are damaged or end early the contents end, which is counted in `losses`: the bytes there are
/// those of the packed file. Fails with kMissingDependency (Zstandard in a build without it).
[[nodiscard]] Result<std::unique_ptr<ByteSource>> make_unpacked_source(std::unique_ptr<ByteSource> packed,
                                                                       std::shared_ptr<DecodeSummary> losses);

/// Opens a file that lies beside a recording, under its name or with ".gz" or ".zst" behind it; nothing where there is
/// none.
[[nodiscard]] Result<std::unique_ptr<ByteSource>> open_file_beside(const std::filesystem::path& path);

}  // namespace e2lf::recordings
