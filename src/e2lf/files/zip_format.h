// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

/// Signatures and field values of the zip format (PKWARE APPNOTE 6.3), shared by the reader and the writer.
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

}  // namespace e2lf::zip
