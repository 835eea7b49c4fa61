// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "e2lf/base/result.h"

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

}  // namespace e2lf::recordings
