// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

namespace e2lf::recordings::evt3 {

/// Shuffle tables for every set of eight 16-bit lanes (a byte): the byte positions from which a shuffle takes its
/// lanes; 0x80 = none.
struct LaneTables {
  alignas(16) uint8_t fill[256][16];      ///< lane i is the last lane of the set up to i
  alignas(16) uint8_t compress[256][16];  ///< lane k is the k-th lane of the set
};

inline constexpr LaneTables kLaneTables = [] {
  LaneTables tables{};
  const auto put = [](uint8_t* row, size_t lane, int from) {
    row[2 * lane] = static_cast<uint8_t>(from < 0 ? 0x80 : 2 * from);
    row[2 * lane + 1] = static_cast<uint8_t>(from < 0 ? 0x80 : 2 * from + 1);
  };
  for (size_t set = 0; set < 256; ++set) {
    int last = -1;
    size_t count = 0;
    for (size_t lane = 0; lane < 8; ++lane) {
      if (((set >> lane) & 1) != 0) {
        last = static_cast<int>(lane);
        put(tables.compress[set], count++, last);
      }
      put(tables.fill[set], lane, last);
    }
    for (; count < 8; ++count) put(tables.compress[set], count, -1);
  }
  return tables;
}();

}  // namespace e2lf::recordings::evt3
