// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/io/bytes.h"
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

/// The record at which reading continues, and the clock there.
struct Place {
  uint64_t record = 0;
  TimeUnwrapper<32> clock;
};

/// Finds a position after which no event at or after t_us is missed, near the first of them. Evenly spaced records show
/// how often the clock wrapped around, and bisection continues between two of them. If their times do not increase, or
/// differ by more than kMaxStepUs, wraps cannot be counted, and the position is the first record. `header_bytes` is the
/// offset of the records. Fails with kUnsupported (not seekable) and kIo; the position of the source is unspecified
/// afterwards.
[[nodiscard]] Result<Place> find_place_before(ByteSource& source, uint64_t header_bytes, int64_t t_us);

/// Maximum time between the evenly spaced records (4.5 minutes), and their minimum distance in records.
inline constexpr int64_t kMaxStepUs = int64_t{1} << 28;
inline constexpr uint64_t kMinStride = uint64_t{1} << 16;

}  // namespace e2lf::recordings::dat
