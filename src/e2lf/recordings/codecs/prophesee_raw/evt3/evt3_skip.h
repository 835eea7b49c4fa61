// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_words.h"

namespace e2lf::recordings::evt3 {

/// Words w with (w & mask) == value, which selects one type or two neighbouring ones.
struct TypeSet {
  uint16_t mask, value;
};
inline constexpr TypeSet only(Type type) {
  return {0xF000, static_cast<uint16_t>(type << 12)};
}
inline constexpr TypeSet kVectors = {0xE000, kVect12 << 12};  ///< kVect12 and kVect8

/// Returns the index of the first trigger, or of the first TIME_HIGH word that differs from `time_high`; `count` if
/// there is none.
[[nodiscard]] size_t find_mark(const uint8_t* words, size_t count, uint16_t time_high);

/// Returns the index of the last word of some types, or `count` if there is none.
[[nodiscard]] size_t find_last(const uint8_t* words, size_t count, TypeSet types);

/// The scalar references of the two functions above.
[[nodiscard]] size_t find_mark_scalar(const uint8_t* words, size_t count, uint16_t time_high);
[[nodiscard]] size_t find_last_scalar(const uint8_t* words, size_t count, TypeSet types);

}  // namespace e2lf::recordings::evt3
