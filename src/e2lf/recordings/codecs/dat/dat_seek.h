// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "e2lf/recordings/codecs/dat/time_unwrapper.h"
#include "e2lf/recordings/io/byte_source.h"

namespace e2lf::recordings::dat {

/// Where reading goes on, and the clock there.
struct Place {
  uint64_t record = 0;
  TimeUnwrapper clock;
};

/// A place from which on no event of t_us or later is missed, near the first of them: evenly spaced records tell how
/// often the clock has wrapped, and bisection goes on between two of them. Where their times do not ascend, or are more
/// than kMaxStepUs apart, wraps cannot be told, and it is the first record. `header_bytes` is where the records begin.
/// Fails with kUnsupported (not seekable) and kIo; the source is then anywhere.
[[nodiscard]] Result<Place> find_place_before(ByteSource& source, uint64_t header_bytes, int64_t t_us);

/// How far the evenly spaced records may be apart in time (4.5 minutes), and are in number, at least.
inline constexpr int64_t kMaxStepUs = int64_t{1} << 28;
inline constexpr uint64_t kMinStride = uint64_t{1} << 16;

}  // namespace e2lf::recordings::dat
