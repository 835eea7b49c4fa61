// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "e2lf/base/result.h"

namespace e2lf::recordings::ecf {

/// The ECF compression of one chunk of events, as Metavision HDF5 files store it (HDF5 filter 36559 = 0x8ECF).
/// A chunk is little-endian:
///   u32  events << 2 | pack_yxp << 1 | pack_xp
///   u64  time of the first event, then runs of equal times: a byte dt(4) | count(4); count 15: a u16 count follows;
///        dt 15: the count nibble is a base-16 digit (lowest first) of a long gap, added before the next run
///   pack_yxp: four 24-bit values y << 12 | x << 1 | p in three u32, or else
///   runs of equal y: u16 y << 5 | count (31: a u16 count follows), and then
///   pack_xp: four 12-bit values x << 1 | p in three u16, or else
///     x groups: u16 x << 5 | mask, bit 4 - i set when the next event is at x + 1 + i, and
///     runs of equal p: u8 p << 7 | count (127: a u16 count follows).

inline constexpr size_t kMaxChunkEvents = 65535;
inline constexpr uint16_t kMaxCoordinate = 2047;  ///< x and y have 11 bits
inline constexpr uint64_t kEndOfTime = uint64_t{1} << 62;

/// The columns of one chunk, of equal length.
struct ChunkColumns {
  std::span<const uint16_t> x, y;
  std::span<const uint8_t> p;
  std::span<const int64_t> t;
};
struct MutableChunkColumns {
  std::span<uint16_t> x, y;
  std::span<uint8_t> p;
  std::span<int64_t> t;
};

/// Returns whether ECF can represent these events exactly: times are not negative and do not decrease, coordinates have
/// 11 bits, p is 0 or 1, and there are 1 to kMaxChunkEvents of them.
[[nodiscard]] bool can_encode(const ChunkColumns& events);

/// Returns the maximum number of bytes that encode() writes for this many events.
[[nodiscard]] size_t max_encoded_size(size_t events);

/// Compresses one chunk to `out` with the smallest of the three layouts, and returns the number of bytes used.
/// Contract: can_encode(events) and out.size() >= max_encoded_size(events.x.size()).
[[nodiscard]] size_t encode(const ChunkColumns& events, std::span<uint8_t> out);

/// Returns the number of events that a compressed chunk states. Fails with kTruncated and kFormat.
[[nodiscard]] Result<size_t> event_count(std::span<const uint8_t> chunk);

/// Decompresses a chunk to columns of exactly event_count(chunk) events. Fails with kTruncated (the chunk ends early)
/// and kFormat (a run exceeds the chunk, or a time exceeds 2^62); the columns are then unspecified.
[[nodiscard]] Result<void> decode(std::span<const uint8_t> chunk, const MutableChunkColumns& events);

/// Removes events that decode() made of zero bytes in place of data, such as an interrupted copy leaves, from the
/// columns of a chunk. Returns the number of events that remain, at the front. Zero bytes are taken for lost data if
/// they are kMinZeros or more events at (0, 0), or at x = 0 with the same y, p and t as a neighbour, which no pixel
/// generates.
[[nodiscard]] size_t drop_zeros(std::span<const uint8_t> chunk, const MutableChunkColumns& events);

inline constexpr size_t kMinZeros = 64;

}  // namespace e2lf::recordings::ecf
