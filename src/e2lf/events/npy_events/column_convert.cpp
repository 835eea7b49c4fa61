// SPDX-License-Identifier: MIT
#include "e2lf/events/npy_events/column_convert.h"

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>
#include <type_traits>

#include "e2lf/base/contract.h"
#include "e2lf/events/little_endian.h"

namespace e2lf::events::npy_events {
namespace {

constexpr std::array<std::string_view, 9> kIntegerTypes = {"u1", "u2", "u4", "u8", "i1", "i2", "i4", "i8", "b1"};

template <typename From, typename To>
void convert(const uint8_t* first, size_t stride, size_t count, To* out, uint8_t* bad) {
  for (size_t i = 0; i < count; ++i) {
    auto value = load_le<From>(first + i * stride);
    if constexpr (std::is_same_v<To, uint8_t> && std::is_signed_v<From>) value = value == -1 ? From{0} : value;
    bad[i] |= value < From{0} && std::is_unsigned_v<To>;
    bad[i] |= static_cast<uint64_t>(value) > static_cast<uint64_t>(std::numeric_limits<To>::max()) && value > From{0};
    out[i] = static_cast<To>(value);
  }
}

}  // namespace

bool is_integer_type(const std::string& type) {
  return std::find(kIntegerTypes.begin(), kIntegerTypes.end(), type) != kIntegerTypes.end();
}

template <typename T>
void to_column(const uint8_t* records, const NumberField& field, size_t count, T* out, uint8_t* bad) {
  const uint8_t* const first = records + field.offset;
  if (field.type == "u1" || field.type == "b1") return convert<uint8_t>(first, field.stride, count, out, bad);
  if (field.type == "u2") return convert<uint16_t>(first, field.stride, count, out, bad);
  if (field.type == "u4") return convert<uint32_t>(first, field.stride, count, out, bad);
  if (field.type == "u8") return convert<uint64_t>(first, field.stride, count, out, bad);
  if (field.type == "i1") return convert<int8_t>(first, field.stride, count, out, bad);
  if (field.type == "i2") return convert<int16_t>(first, field.stride, count, out, bad);
  if (field.type == "i4") return convert<int32_t>(first, field.stride, count, out, bad);
  if (field.type == "i8") return convert<int64_t>(first, field.stride, count, out, bad);
  E2LF_REQUIRE(false, "not an integer type: " + field.type);
}

template void to_column(const uint8_t*, const NumberField&, size_t, uint8_t*, uint8_t*);
template void to_column(const uint8_t*, const NumberField&, size_t, uint16_t*, uint8_t*);
template void to_column(const uint8_t*, const NumberField&, size_t, int64_t*, uint8_t*);

size_t remove_bad(EventColumns& events, size_t begin, const Column<uint8_t>& bad) {
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

}  // namespace e2lf::events::npy_events
