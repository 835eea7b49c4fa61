// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "e2lf/recordings/codecs/dat/time_unwrapper.h"
#include "e2lf/recordings/io/byte_source.h"

namespace e2lf::recordings::dat {

/// The record at which reading continues, and the clock there.
struct Place {
  uint64_t record = 0;
  TimeUnwrapper clock;
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
