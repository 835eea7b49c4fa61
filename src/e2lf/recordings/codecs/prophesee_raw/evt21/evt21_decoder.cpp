// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/prophesee_raw/evt21/evt21_decoder.h"

#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_kernels.h"

namespace e2lf::recordings::evt21 {
namespace {

template <ByteOrder kOrder>
constexpr timed::Encoding kEncoding =
    kOrder == ByteOrder::kLittle ? timed::Encoding::kEvt21Little : timed::Encoding::kEvt21Legacy;

constexpr size_t kLookedAt = 512;

/// Returns the number of invalid words among some.
template <ByteOrder kOrder>
size_t bad_words(std::span<const uint8_t> words) {
  const size_t count = std::min(words.size() / 8, kLookedAt);
  return timed::Words<Layout<kOrder>>::count_bad(words.data(), count, count);
}

/// Returns the number of valid words before the first invalid one, in steps and up to a limit.
template <ByteOrder kOrder>
size_t good_words(std::span<const uint8_t> words) {
  constexpr size_t kStep = 8;
  const size_t count = std::min(words.size() / 8, kLookedAt);
  size_t good = 0;
  while (good < count) {
    const size_t next = std::min(good + kStep, count);
    if (timed::Words<Layout<kOrder>>::count_bad(words.data(), next, 1) != 0) break;
    good = next;
  }
  return good;
}

}  // namespace

template <ByteOrder kOrder>
size_t Codec<kOrder>::check(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits) {
  return timed::kernels(kEncoding<kOrder>).check(words, count, check, limits);
}

template <ByteOrder kOrder>
size_t Codec<kOrder>::decode(const uint8_t* words, size_t count, State& state, const SensorLimits& limits,
                             ColumnSink& sink) {
  return timed::kernels(kEncoding<kOrder>).decode(words, count, state, limits, sink);
}

template struct Codec<ByteOrder::kLittle>;
template struct Codec<ByteOrder::kLegacy>;

ByteOrder find_byte_order(std::span<const uint8_t> words, const std::string& hint) {
  size_t little = good_words<ByteOrder::kLittle>(words);
  size_t legacy = good_words<ByteOrder::kLegacy>(words);
  if (little == legacy) {
    // A damaged word ends both counts and says nothing about the others.
    little = kLookedAt - bad_words<ByteOrder::kLittle>(words);
    legacy = kLookedAt - bad_words<ByteOrder::kLegacy>(words);
  }
  if (little == legacy) return hint == "legacy" ? ByteOrder::kLegacy : ByteOrder::kLittle;
  return little > legacy ? ByteOrder::kLittle : ByteOrder::kLegacy;
}

}  // namespace e2lf::recordings::evt21
