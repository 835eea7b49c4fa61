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

/// Where one number of an event is within records `stride` bytes apart; a plain column has offset 0.
struct NumberField {
  std::string type;  ///< numpy code: "u1".."u8", "i1".."i8", "b1", "f4", "f8"
  size_t offset = 0;
  size_t stride = 0;
};

/// The numbers of an event within records.
struct RecordFields {
  NumberField x, y, p, t;
  TimeUnit unit = TimeUnit::kMicroseconds;
  PolarityCode polarity = {};
};

/// True for the types that to_column reads.
[[nodiscard]] bool is_number_type(const std::string& type);

/// The number of each of `count` records as T. Those that do not fit, or are not whole, set bad[i].
template <typename T>
void to_column(const uint8_t* records, const NumberField& field, size_t count, T* out, uint8_t* bad);

/// Times in microseconds, rounded (whole nanoseconds are rounded down); kAuto is microseconds. Those beyond
/// kTimeLimitUs set bad[i].
void to_times(const uint8_t* records, const NumberField& field, TimeUnit unit, size_t count, int64_t* out,
              uint8_t* bad);

/// The events of `count` records; returns how many of them are none.
size_t to_events(const uint8_t* records, const RecordFields& fields, size_t count, EventColumns& events);

/// The polarity of each of `count` records, 0 or 1. Those that `code` does not know set bad[i].
void to_polarities(const uint8_t* records, const NumberField& field, const PolarityCode& code, size_t count,
                   uint8_t* out, uint8_t* bad);

/// The number of each of `count` records, for decide_layout().
[[nodiscard]] std::vector<double> to_doubles(const uint8_t* records, const NumberField& field, size_t count);

/// Whether numbers of a type are whole.
[[nodiscard]] bool is_integer_type(const std::string& type);

/// Removes the events whose bad[i] is set from the columns, from `begin` on; returns how many.
size_t remove_bad(EventColumns& events, size_t begin, const Column<uint8_t>& bad);

/// So many rows tell columns, units and polarities.
inline constexpr size_t kSampledRows = 4096;

}  // namespace e2lf::recordings::table
