// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::dat {

inline constexpr size_t kRecordBytes = 8;
inline constexpr uint8_t kTypeEvent2d = 0x00;
inline constexpr uint8_t kTypeCd = 0x0C;
inline constexpr uint8_t kTypeTrigger = 0x0E;

struct Header {
  RecordingInfo info;
  int version = 1;
  uint8_t type = kTypeCd;
  size_t bytes = 0;  ///< offset of the records
};

/// Parses the text header and the two bytes after it. Returns nothing if `head` is not the start of a DAT file: no "%"
/// line, the keys of a RAW file, or another record type or size.
[[nodiscard]] std::optional<Header> parse_header(std::span<const uint8_t> head);

/// Returns the header of a version 2 file.
[[nodiscard]] std::string make_header(const RecordingInfo& info, uint8_t type);

}  // namespace e2lf::recordings::dat
