// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/event.h"
#include "e2lf/recordings/recording.h"
#include "e2lf/recordings/table/layout.h"

namespace e2lf::recordings::table {

/// The position of one field of an event in records that are `stride` bytes apart; a separate column has offset 0.
struct NumberField {
  std::string type;  ///< numpy code: "u1".."u8", "i1".."i8", "b1", "f4", "f8"
  size_t offset = 0;
  size_t stride = 0;
};

/// The fields of an event in records.
struct RecordFields {
  NumberField x, y, p, t;
  TimeUnit unit = TimeUnit::kMicroseconds;
  PolarityCode polarity = {};
};

/// Returns whether to_column() reads a type.
[[nodiscard]] bool is_number_type(const std::string& type);

/// Converts a field of `count` records to T. Sets bad[i] for values that do not fit or are not integers.
template <typename T>
void to_column(const uint8_t* records, const NumberField& field, size_t count, T* out, uint8_t* bad);

/// Converts times to microseconds, rounded (integral nanoseconds are rounded down). kAuto is microseconds. Sets bad[i]
/// for times beyond kTimeLimitUs.
void to_times(const uint8_t* records, const NumberField& field, TimeUnit unit, size_t count, int64_t* out,
              uint8_t* bad);

/// Appends the events of `count` records, and returns the number of records that are not events.
size_t to_events(const uint8_t* records, const RecordFields& fields, size_t count, EventColumns& events);

/// Converts the polarities of `count` records to 0 or 1. Sets bad[i] for values that `code` does not contain.
void to_polarities(const uint8_t* records, const NumberField& field, const PolarityCode& code, size_t count,
                   uint8_t* out, uint8_t* bad);

/// Returns the field of `count` records as doubles, for decide_layout().
[[nodiscard]] std::vector<double> to_doubles(const uint8_t* records, const NumberField& field, size_t count);

/// Returns whether numbers of a type are integers.
[[nodiscard]] bool is_integer_type(const std::string& type);

/// Removes the events from `begin` on whose bad[i] is set, and returns their number.
size_t remove_bad(EventColumns& events, size_t begin, const Column<uint8_t>& bad);

/// Number of rows from which columns, units and polarities are determined.
inline constexpr size_t kSampledRows = 4096;

}  // namespace e2lf::recordings::table
