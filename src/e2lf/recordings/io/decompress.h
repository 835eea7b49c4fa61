// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::recordings {

/// The compression of a packet; the numbers are those of AEDAT 4.
enum class Compression : int32_t { kNone = 0, kLz4 = 1, kLz4High = 2, kZstd = 3, kZstdHigh = 4 };

/// Largest uncompressed size of a packet; larger values are treated as damage.
inline constexpr size_t kMaxPacketBytes = size_t{1} << 26;

/// Fails with kUnsupported (unknown) or kMissingDependency (Zstandard in a build without it) for a compression that
/// decompress() does not read.
[[nodiscard]] Result<void> check_compression(Compression compression);

/// Replaces `out` by the content of a packet. Fails with kFormat (damaged), kTruncated and kUnsupported (too large),
/// and as check_compression() does.
[[nodiscard]] Result<void> decompress(Compression compression, std::span<const uint8_t> packed,
                                      std::vector<uint8_t>& out);

}  // namespace e2lf::recordings
