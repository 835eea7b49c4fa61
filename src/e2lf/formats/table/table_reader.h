// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/formats/table/layout.h"
#include "e2lf/recordings/event.h"
#include "e2lf/recordings/event_blocks.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::formats::table {

/// The position of one field of an event in records that are `stride` bytes apart; a separate column has offset 0.
struct NumberField {
  std::string type;  ///< numpy code: "u1".."u8", "i1".."i8", "b1", "f2".."f8"
  size_t offset = 0;
  size_t stride = 0;
};

/// The fields of an event in records.
struct RecordFields {
  NumberField x, y, p, t;
  TimeUnit unit = TimeUnit::kMicroseconds;
  PolarityCode polarity = {};
};

/// The records that contain x, y, p and t, by Field.
using RecordsOfFields = std::array<const uint8_t*, kNumFields>;

/// Returns whether to_column() reads a type.
[[nodiscard]] bool is_number_type(const std::string& type);

/// Converts a field of `count` records to T. Sets bad[i] for values that do not fit or are not integers.
template <typename T>
void to_column(const uint8_t* records, const NumberField& field, size_t count, T* out, uint8_t* bad);

/// Converts times to microseconds, rounded (integral nanoseconds are rounded down). kAuto is microseconds. Sets bad[i]
/// for times beyond kTimeLimitUs.
void to_times(const uint8_t* records, const NumberField& field, TimeUnit unit, size_t count, int64_t* out,
              uint8_t* bad);

/// Replaces `events` by those of `count` records, and returns the number of records that are not events.
size_t to_events(const RecordsOfFields& records, const RecordFields& fields, size_t count, EventColumns& events);

/// Returns the field of `count` records as doubles, for decide_layout().
[[nodiscard]] std::vector<double> to_doubles(const uint8_t* records, const NumberField& field, size_t count);

/// Returns the sample of a column that has a name and is a field of `count` records.
[[nodiscard]] TableSample::Column sample_of(std::string name, const uint8_t* records, const NumberField& field,
                                            size_t count);

/// Number of rows from which columns, units and polarities are determined.
inline constexpr size_t kSampledRows = 4096;

}  // namespace e2lf::formats::table
