// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "e2lf/recordings/io/byte_source.h"
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

/// Computes full times from the low 32 bits in records. A forward step of less than a quarter of the range (17 minutes)
/// may wrap the clock; a backward step of this size is a late event, possibly from before the wrap; larger steps are
/// damage. If kMaxOdd records in a row contradict this, they are correct: there was a pause, or the step before them
/// was the damage.
class TimeUnwrapper {
 public:
  TimeUnwrapper() = default;
  /// Continues after a record with this time.
  explicit TimeUnwrapper(int64_t t_us)
      : base_us_(t_us & ~int64_t{UINT32_MAX}), last_(static_cast<uint32_t>(t_us)), has_begun_(true) {}

  int64_t operator()(uint32_t low) {
    if (!has_begun_) {
      has_begun_ = true;
      last_ = low;
    }
    const uint32_t ahead = low - last_;
    if (ahead < kQuarter) [[likely]] {
      if (low < last_) base_us_ += kCircleUs;
      last_ = low;
      num_odd_ = 0;
      return base_us_ + low;
    }
    const bool is_before_wrap = ahead >= 3 * kQuarter && low > last_ && base_us_ > 0;
    const int64_t base_us = is_before_wrap ? base_us_ - kCircleUs : base_us_;
    if (++num_odd_ == kMaxOdd) *this = TimeUnwrapper(base_us + low);
    return base_us + low;
  }

 private:
  static constexpr uint32_t kQuarter = uint32_t{1} << 30;
  static constexpr int64_t kCircleUs = int64_t{1} << 32;
  static constexpr int kMaxOdd = 16;
  int64_t base_us_ = 0;
  uint32_t last_ = 0;
  int num_odd_ = 0;  ///< number of consecutive records that do not continue from last_
  bool has_begun_ = false;
};

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
