// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

/// Random damage of bytes, for tests and fuzzing.
namespace e2lf::recordings {

enum class Damage { kLost, kInserted, kFlipped, kZeroed, kOverwritten, kTruncated };
inline constexpr int kNumDamages = 6;

struct DamagedPlace {
  size_t begin = 0;  ///< where the damage begins
  size_t size = 0;   ///< number of affected bytes of the undamaged data
};

/// Damages `bytes` after `first` in one place, by up to `max_size` bytes.
inline DamagedPlace damage(std::vector<uint8_t>& bytes, size_t first, Damage kind, size_t max_size,
                           std::mt19937& random) {
  const size_t begin = first + random() % (bytes.size() - first);
  const size_t size = std::min<size_t>(1 + random() % max_size, bytes.size() - begin);
  const auto at = bytes.begin() + static_cast<ptrdiff_t>(begin);
  const auto end = at + static_cast<ptrdiff_t>(size);
  const auto any = [&random] { return static_cast<uint8_t>(random()); };
  switch (kind) {
    case Damage::kLost:
      bytes.erase(at, end);
      return {begin, size};
    case Damage::kInserted: {
      std::vector<uint8_t> added(size);
      std::generate(added.begin(), added.end(), any);
      bytes.insert(at, added.begin(), added.end());
      return {begin, 0};
    }
    case Damage::kFlipped:
      *at ^= static_cast<uint8_t>(1u << (random() % 8));
      return {begin, 1};
    case Damage::kZeroed:
      std::fill(at, end, uint8_t{0});
      return {begin, size};
    case Damage::kOverwritten:
      std::generate(at, end, any);
      return {begin, size};
    case Damage::kTruncated:
      break;
  }
  const size_t left = bytes.size() - begin;
  bytes.erase(at, bytes.end());
  return {begin, left};
}

}  // namespace e2lf::recordings
