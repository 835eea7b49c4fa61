// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

namespace e2lf {

static_assert(std::endian::native == std::endian::little, "the codecs read and write little-endian words in place");

/// Reads the little-endian word at `bytes`, which need not be aligned.
template <typename T>
[[nodiscard]] inline T load_le(const uint8_t* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

template <typename T>
inline void store_le(uint8_t* bytes, T value) {
  std::memcpy(bytes, &value, sizeof(T));
}

}  // namespace e2lf
