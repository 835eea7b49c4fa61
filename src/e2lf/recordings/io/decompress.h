// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/io/bytes.h"

namespace e2lf::recordings {

/// The compression of a packet; the numbers are those of AEDAT 4.
enum class Compression : int32_t { kNone = 0, kLz4 = 1, kLz4High = 2, kZstd = 3, kZstdHigh = 4 };

/// Largest uncompressed size of a packet; larger values are treated as damage.
inline constexpr size_t kMaxPacketBytes = size_t{1} << 26;

/// Decompresses data, with the state that the library needs.
class Decompressor {
 public:
  enum class State { kInside, kBetweenParts, kDamaged };
  virtual ~Decompressor() = default;

  /// Decompresses the available bytes and advances both spans by what it used.
  virtual State step(std::span<const uint8_t>& packed, std::span<uint8_t>& room) = 0;

  /// Returns to the state before the first step.
  virtual void reset() {}

  /// Replaces `out` by the content of a packet. Fails with kFormat (damaged), kTruncated and kUnsupported (too large).
  [[nodiscard]] Result<void> unpack(std::span<const uint8_t> packed, std::vector<uint8_t>& out);
};

using DecompressorPtr = std::unique_ptr<Decompressor>;

/// Creates a decompressor. Fails with kUnsupported (unknown code) and kMissingDependency (Zstd in a build without it).
[[nodiscard]] Result<DecompressorPtr> make_decompressor(Compression compression);

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
