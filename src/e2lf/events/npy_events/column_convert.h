// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "e2lf/events/event.h"

namespace e2lf::events::npy_events {

/// Where one number of an event is within records `stride` bytes apart; a plain column has offset 0.
struct NumberField {
  std::string type;  ///< numpy code: "u1".."u8", "i1".."i8", "b1"
  size_t offset = 0;
  size_t stride = 0;
};

/// True for the types that to_column reads.
[[nodiscard]] bool is_integer_type(const std::string& type);

/// The number of each of `count` records as T. Those that do not fit set bad[i]; -1 fits uint8_t as 0 (a polarity).
template <typename T>
void to_column(const uint8_t* records, const NumberField& field, size_t count, T* out, uint8_t* bad);

/// Removes the events whose bad[i] is set from the columns, from `begin` on; returns how many.
size_t remove_bad(EventColumns& events, size_t begin, const Column<uint8_t>& bad);

}  // namespace e2lf::events::npy_events
