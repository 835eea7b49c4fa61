// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/numpy/column_convert.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <type_traits>

#include "e2lf/base/contract.h"
#include "e2lf/base/little_endian.h"
#include "e2lf/base/text.h"

namespace e2lf::recordings::numpy {
namespace {

/// Calls visit(T{}) with the type of the code; false for a code that is none.
template <typename Visit>
bool with_number_type(std::string_view code, Visit&& visit) {
  if (code == "u1" || code == "b1") return visit(uint8_t{}), true;
  if (code == "u2") return visit(uint16_t{}), true;
  if (code == "u4") return visit(uint32_t{}), true;
  if (code == "u8") return visit(uint64_t{}), true;
  if (code == "i1") return visit(int8_t{}), true;
  if (code == "i2") return visit(int16_t{}), true;
  if (code == "i4") return visit(int32_t{}), true;
  if (code == "i8") return visit(int64_t{}), true;
  if (code == "f4") return visit(float{}), true;
  if (code == "f8") return visit(double{}), true;
  return false;
}

/// One number as To; true where it does not fit.
template <typename From, typename To>
bool convert_one(From value, To& out) {
  if constexpr (std::is_same_v<To, uint8_t> && !std::is_unsigned_v<From>) value = value == From{-1} ? From{0} : value;
  if constexpr (std::is_floating_point_v<From>) {
    const auto number = static_cast<double>(value);
    const bool fits = number == std::trunc(number) && number >= static_cast<double>(std::numeric_limits<To>::min()) &&
                      number < std::ldexp(1.0, std::numeric_limits<To>::digits);
    out = fits ? static_cast<To>(number) : To{};
    return !fits;
  } else {
    out = static_cast<To>(value);
    return (value < From{0} && std::is_unsigned_v<To>) ||
           (static_cast<uint64_t>(value) > static_cast<uint64_t>(std::numeric_limits<To>::max()) && value > From{0});
  }
}

double us_per(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::kSeconds:
      return 1e6;
    case TimeUnit::kMilliseconds:
      return 1e3;
    case TimeUnit::kNanoseconds:
      return 1e-3;
    case TimeUnit::kAuto:
    case TimeUnit::kMicroseconds:
      break;
  }
  return 1.0;
}

/// A time in microseconds; true where it is none.
template <typename From>
bool convert_time(From value, TimeUnit unit, int64_t& out) {
  if constexpr (std::is_floating_point_v<From>) {
    const double us = static_cast<double>(value) * us_per(unit);
    const bool fits = std::fabs(us) <= static_cast<double>(kTimeLimitUs);
    out = fits ? static_cast<int64_t>(std::llround(us)) : 0;
    return !fits;
  } else {
    if (convert_one(value, out)) return true;
    if (unit == TimeUnit::kNanoseconds) {
      out = out / 1000 - (out % 1000 < 0 ? 1 : 0);
      return false;
    }
    const auto factor = static_cast<int64_t>(us_per(unit));
    return factor != 1 && __builtin_mul_overflow(out, factor, &out);
  }
}

/// Whether no value falls below the one before it.
bool never_falls(std::span<const std::array<double, 4>> rows, size_t column) {
  return std::is_sorted(rows.begin(), rows.end(), [&](const auto& a, const auto& b) { return a[column] < b[column]; });
}

/// Whether the values cannot be coordinates.
bool exceeds_coordinates(std::span<const std::array<double, 4>> rows, size_t column) {
  return std::any_of(rows.begin(), rows.end(), [&](const auto& row) {
    return row[column] != std::trunc(row[column]) || row[column] > UINT16_MAX || row[column] < 0;
  });
}

bool are_polarities(std::span<const std::array<double, 4>> rows, size_t column) {
  return std::all_of(rows.begin(), rows.end(),
                     [&](const auto& row) { return row[column] == 0 || row[column] == 1 || row[column] == -1; });
}

}  // namespace

bool is_number_type(const std::string& type) {
  return with_number_type(type, [](auto) {});
}

template <typename T>
void to_column(const uint8_t* records, const NumberField& field, size_t count, T* out, uint8_t* bad) {
  const bool known = with_number_type(field.type, [&](auto type) {
    using From = decltype(type);
    const uint8_t* next = records + field.offset;
    for (size_t i = 0; i < count; ++i, next += field.stride) bad[i] |= convert_one(load_le<From>(next), out[i]);
  });
  E2LF_REQUIRE(known, "not a type of numbers: " + field.type);
}

template void to_column(const uint8_t*, const NumberField&, size_t, uint8_t*, uint8_t*);
template void to_column(const uint8_t*, const NumberField&, size_t, uint16_t*, uint8_t*);
template void to_column(const uint8_t*, const NumberField&, size_t, int64_t*, uint8_t*);

void to_times(const uint8_t* records, const NumberField& field, TimeUnit unit, size_t count, int64_t* out,
              uint8_t* bad) {
  const bool known = with_number_type(field.type, [&](auto type) {
    using From = decltype(type);
    const uint8_t* next = records + field.offset;
    for (size_t i = 0; i < count; ++i, next += field.stride) bad[i] |= convert_time(load_le<From>(next), unit, out[i]);
  });
  E2LF_REQUIRE(known, "not a type of numbers: " + field.type);
}

size_t to_events(const uint8_t* records, const RecordFields& fields, size_t count, EventColumns& events) {
  events.resize(count);
  Column<uint8_t> bad(count);
  std::fill(bad.begin(), bad.end(), uint8_t{0});
  to_column(records, fields.x, count, events.x.data(), bad.data());
  to_column(records, fields.y, count, events.y.data(), bad.data());
  to_column(records, fields.p, count, events.p.data(), bad.data());
  to_times(records, fields.t, fields.unit, count, events.t.data(), bad.data());
  for (size_t i = 0; i < count; ++i) bad[i] |= events.p[i] > 1;
  return remove_bad(events, 0, bad);
}

TimeUnit find_time_unit(TimeUnit named, const uint8_t* records, const NumberField& times, size_t count,
                        std::vector<Assumption>& assumptions) {
  if (named != TimeUnit::kAuto) return named;
  if (times.type != "f4" && times.type != "f8") return TimeUnit::kMicroseconds;
  bool are_whole = true, is_any_set = false;
  with_number_type(times.type, [&](auto type) {
    const uint8_t* next = records + times.offset;
    for (size_t i = 0; i < count; ++i, next += times.stride) {
      const auto time = static_cast<double>(load_le<decltype(type)>(next));
      are_whole = are_whole && time == std::trunc(time);
      is_any_set = is_any_set || time != 0;
    }
  });
  if (count == 0) return TimeUnit::kMicroseconds;
  const bool are_us = are_whole && is_any_set;
  assumptions.push_back({are_us ? "times are whole numbers and were read as microseconds"
                                : "times are not whole numbers and were read as seconds",
                         Setting::kTimeUnit});
  return are_us ? TimeUnit::kMicroseconds : TimeUnit::kSeconds;
}

size_t remove_bad(EventColumns& events, size_t begin, const Column<uint8_t>& bad) {
  if (std::find_if(bad.begin(), bad.end(), [](uint8_t b) { return b != 0; }) == bad.end()) return 0;
  size_t kept = begin;
  for (size_t i = begin; i < events.size(); ++i) {
    if (bad[i - begin] != 0) continue;
    events.x[kept] = events.x[i];
    events.y[kept] = events.y[i];
    events.p[kept] = events.p[i];
    events.t[kept] = events.t[i];
    ++kept;
  }
  const size_t removed = events.size() - kept;
  events.resize(kept);
  return removed;
}

Result<std::string> find_column_order(std::span<const std::array<double, 4>> rows, const std::string& given,
                                      const std::string& location) {
  std::string letters = given;
  std::sort(letters.begin(), letters.end());
  if (letters == "ptxy") return given;
  if (!given.empty()) {
    return Error{ErrorCode::kInvalidValue, "the columns are t, x, y and p in some order; write it as txyp", location,
                 Setting::kColumns};
  }
  const bool p_is_last = are_polarities(rows, 3), p_is_third = are_polarities(rows, 2);
  if (!rows.empty() && p_is_third && !p_is_last) return std::string("xypt");
  if (!rows.empty() && p_is_last && !p_is_third) {
    const bool first_is_large = exceeds_coordinates(rows, 0), third_is_large = exceeds_coordinates(rows, 2);
    if (first_is_large != third_is_large) return std::string(first_is_large ? "txyp" : "xytp");
    const bool first_rises = never_falls(rows, 0), third_rises = never_falls(rows, 2);
    if (first_rises != third_rises) return std::string(first_rises ? "txyp" : "xytp");
  }
  return Error{ErrorCode::kInvalidValue,
               "the values do not tell which of the four columns are t, x, y and p; name them, as txyp", location,
               Setting::kColumns};
}

Assumption column_assumption(const std::string& order) {
  return {cat("the columns were read as ", order[0], ", ", order[1], ", ", order[2], ", ", order[3]),
          Setting::kColumns};
}

std::vector<std::array<double, 4>> sample_rows(const uint8_t* rows, const std::string& type, size_t item_size,
                                               size_t count) {
  std::vector<std::array<double, 4>> sample(count);
  with_number_type(type, [&](auto number) {
    using From = decltype(number);
    for (size_t i = 0; i < 4 * count; ++i) {
      sample[i / 4][i % 4] = static_cast<double>(load_le<From>(rows + i * item_size));
    }
  });
  return sample;
}

RecordFields fields_of_rows(const std::string& order, const std::string& type, size_t item_size) {
  const auto field = [&](char letter) { return NumberField{type, order.find(letter) * item_size, 4 * item_size}; };
  return {field('x'), field('y'), field('p'), field('t')};
}

}  // namespace e2lf::recordings::numpy
