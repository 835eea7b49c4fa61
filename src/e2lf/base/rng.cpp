// SPDX-License-Identifier: MIT
#include "e2lf/base/rng.h"

#include <algorithm>

#include "e2lf/base/result.h"

namespace e2lf {
namespace {

constexpr uint32_t kMultiplier0 = 0xD2511F53, kMultiplier1 = 0xCD9E8D57;
constexpr uint32_t kWeyl0 = 0x9E3779B9, kWeyl1 = 0xBB67AE85;

}  // namespace

std::array<uint32_t, 4> philox4x32(std::array<uint32_t, 4> counter, std::array<uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const uint64_t product0 = uint64_t{kMultiplier0} * counter[0];
    const uint64_t product1 = uint64_t{kMultiplier1} * counter[2];
    counter = {static_cast<uint32_t>(product1 >> 32) ^ counter[1] ^ key[0], static_cast<uint32_t>(product1),
               static_cast<uint32_t>(product0 >> 32) ^ counter[3] ^ key[1], static_cast<uint32_t>(product0)};
    key = {key[0] + kWeyl0, key[1] + kWeyl1};
  }
  return counter;
}

std::array<uint32_t, 4> CounterRng::bits(uint64_t index) const {
  return philox4x32({static_cast<uint32_t>(index), static_cast<uint32_t>(index >> 32), static_cast<uint32_t>(stream_),
                     static_cast<uint32_t>(stream_ >> 32)},
                    {static_cast<uint32_t>(seed_), static_cast<uint32_t>(seed_ >> 32)});
}

float CounterRng::uniform(uint64_t index) const {
  return static_cast<float>(bits(index)[0] >> 8) * 0x1p-24F;
}

std::array<float, 2> CounterRng::normal2(uint64_t index) const {
  const auto words = bits(index);
  // The float32 nearest to a word close to 2^32 is 2^32 itself. The minimum keeps the argument of the logarithm at or
  // below one.
  const float u0 = std::min((static_cast<float>(words[0]) + 0.5F) * 0x1p-32F, 1.0F);
  const float radius = std::sqrt(-2.0F * std::log(u0));
  const float angle = static_cast<float>(words[1]) * (2.0F * std::numbers::pi_v<float> * 0x1p-32F);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

uint32_t CounterRng::below(uint64_t index, uint32_t bound) const {
  E2LF_REQUIRE(bound >= 1, "below() needs a bound of at least 1");
  return static_cast<uint32_t>((uint64_t{bits(index)[0]} * bound) >> 32);
}

}  // namespace e2lf
