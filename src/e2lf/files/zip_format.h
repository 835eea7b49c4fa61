// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

/// Signatures, field values and records of the zip format (PKWARE APPNOTE 6.3), shared by its readers and writers.
namespace e2lf::zip {

inline constexpr uint32_t kLocalHeader = 0x04034b50;
inline constexpr uint32_t kDirectoryEntry = 0x02014b50;
inline constexpr uint32_t kDirectoryEnd = 0x06054b50;
inline constexpr uint32_t kDirectoryEnd64 = 0x06064b50;
inline constexpr uint32_t kLocator64 = 0x07064b50;

inline constexpr uint64_t kLocalHeaderSize = 30;
inline constexpr uint64_t kDirectoryEntrySize = 46;
inline constexpr uint64_t kDirectoryEndSize = 22;
inline constexpr uint64_t kDirectoryEnd64Size = 56;
inline constexpr uint64_t kLocator64Size = 20;

inline constexpr uint16_t kStored = 0;
inline constexpr uint16_t kDeflated = 8;
inline constexpr uint16_t kExtra64 = 1;           ///< id of the extra field with 64-bit sizes
inline constexpr uint32_t kIn64 = 0xFFFFFFFF;     ///< means "the value is in the zip64 record"
inline constexpr uint16_t kCountIn64 = 0xFFFF;    ///< the same for counts
inline constexpr uint16_t kVersion64 = 45;        ///< the version needed to extract
inline constexpr uint16_t kUtf8Names = 1U << 11;  ///< flag

/// A member of an archive, as its local header and its entry in the directory describe it.
struct Member {
  std::string name;
  uint16_t method = kStored;
  uint32_t crc = 0;
  uint64_t packed = 0, size = 0;
  uint64_t offset = 0;  ///< position of its local header in the archive
};

/// Returns the local header of a member. Sizes and offsets of `zip64_from` and more are written in zip64 form; with 0,
/// the length of the header depends on the name alone.
[[nodiscard]] std::vector<uint8_t> local_header(const Member& member, uint64_t zip64_from);

/// Returns the directory of an archive, which begins at `offset`, and its end records.
[[nodiscard]] std::vector<uint8_t> directory(std::span<const Member> members, uint64_t offset, uint64_t zip64_from);

}  // namespace e2lf::zip
