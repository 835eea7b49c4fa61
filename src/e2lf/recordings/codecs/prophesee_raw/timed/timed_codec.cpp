// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_codec.h"

namespace e2lf::recordings::timed {
namespace {

constexpr size_t kLookedAt = 512;

/// Returns the number of invalid words among some.
template <ByteOrder kOrder>
size_t bad_words(std::span<const uint8_t> words) {
  const size_t count = std::min(words.size() / 8, kLookedAt);
  return Words<Evt21Layout<kOrder>>::count_bad(words.data(), count, count);
}

/// Returns the number of valid words before the first invalid one, in steps and up to a limit.
template <ByteOrder kOrder>
size_t good_words(std::span<const uint8_t> words) {
  constexpr size_t kStep = 8;
  const size_t count = std::min(words.size() / 8, kLookedAt);
  size_t good = 0;
  while (good < count) {
    const size_t next = std::min(good + kStep, count);
    if (Words<Evt21Layout<kOrder>>::count_bad(words.data(), next, 1) != 0) break;
    good = next;
  }
  return good;
}

}  // namespace

ByteOrder find_byte_order(std::span<const uint8_t> words, const std::string& hint) {
  size_t little = good_words<ByteOrder::kLittle>(words);
  size_t legacy = good_words<ByteOrder::kLegacy>(words);
  if (little == legacy) {
    // A damaged word ends both counts, whatever the words after it are.
    little = kLookedAt - bad_words<ByteOrder::kLittle>(words);
    legacy = kLookedAt - bad_words<ByteOrder::kLegacy>(words);
  }
  if (little == legacy) return hint == "legacy" ? ByteOrder::kLegacy : ByteOrder::kLittle;
  return little > legacy ? ByteOrder::kLittle : ByteOrder::kLegacy;
}

}  // namespace e2lf::recordings::timed
