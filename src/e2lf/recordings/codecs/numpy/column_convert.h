// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/recordings/event.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::recordings::numpy {

/// Where one number of an event is within records `stride` bytes apart; a plain column has offset 0.
struct NumberField {
  std::string type;  ///< numpy code: "u1".."u8", "i1".."i8", "b1", "f4", "f8"
  size_t offset = 0;
  size_t stride = 0;
};

/// The numbers of an event within records.
struct RecordFields {
  NumberField x, y, p, t;
  TimeUnit unit = TimeUnit::kAuto;
};

/// True for the types that to_column reads.
[[nodiscard]] bool is_number_type(const std::string& type);

/// The number of each of `count` records as T. Those that do not fit, or are not whole, set bad[i]; -1 fits uint8_t as
/// 0 (a polarity).
template <typename T>
void to_column(const uint8_t* records, const NumberField& field, size_t count, T* out, uint8_t* bad);

/// Times in microseconds, rounded (whole nanoseconds are rounded down); kAuto is microseconds. Those beyond
/// kTimeLimitUs set bad[i].
void to_times(const uint8_t* records, const NumberField& field, TimeUnit unit, size_t count, int64_t* out,
              uint8_t* bad);

/// The events of `count` records; returns how many of them are none.
size_t to_events(const uint8_t* records, const RecordFields& fields, size_t count, EventColumns& events);

/// The unit of times: `named`, unless that is kAuto. Then whole numbers are microseconds, also where they are stored as
/// floating-point ones, and other numbers seconds. Looks at the times of `count` records (thousands do), and says in
/// `assumptions`, for people, what it took for granted.
[[nodiscard]] TimeUnit find_time_unit(TimeUnit named, const uint8_t* records, const NumberField& times, size_t count,
                                      std::vector<Assumption>& assumptions);

/// Removes the events whose bad[i] is set from the columns, from `begin` on; returns how many.
size_t remove_bad(EventColumns& events, size_t begin, const Column<uint8_t>& bad);

/// The order of the columns of an array [events, 4]: "txyp" (v2e), "xytp", "xypt" or, where `given`, that. Found by the
/// values of some rows: polarities are -1, 0, 1, and times do not fall or are the only ones that are large or not
/// whole. Fails with kInvalidValue where neither tells.
[[nodiscard]] Result<std::string> find_column_order(std::span<const std::array<double, 4>> rows,
                                                    const std::string& given, const std::string& location);

/// Says for people which order was found.
[[nodiscard]] Assumption column_assumption(const std::string& order);

/// The first rows of an array [events, 4] of one type, for find_column_order.
[[nodiscard]] std::vector<std::array<double, 4>> sample_rows(const uint8_t* rows, const std::string& type,
                                                             size_t item_size, size_t count);

/// The fields of the rows of an array [events, 4] with columns in that order.
[[nodiscard]] RecordFields fields_of_rows(const std::string& order, const std::string& type, size_t item_size);

}  // namespace e2lf::recordings::numpy
