// SPDX-License-Identifier: MIT
// Checks EVT3 words for violations; declared in evt3_decoder.h.
#include <algorithm>
#include <optional>

#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_decoder.h"

namespace e2lf::recordings::evt3 {
namespace {

uint32_t type_of(uint16_t word) {
  return word >> 12;
}

bool is_known(uint16_t word) {
  return ((kKnownTypes >> type_of(word)) & 1) != 0 || word == kPadding;
}

/// Returns the number of steps from `from` to `to` on the 12-bit circle of TIME_HIGH words.
uint32_t steps(uint16_t from, uint16_t to) {
  return (static_cast<uint32_t>(to) - from) & kPayloadMask;
}

bool is_outside(uint16_t word, const SensorLimits& limits) {
  const uint32_t type = type_of(word);
  const uint32_t coordinate = word & kCoordinateMask;
  if (type == kAddrY) return coordinate >= limits.height;
  return (type == kAddrX || type == kVectBaseX) && coordinate >= limits.width;
}

/// Returns whether a word continues an OTHERS word.
bool is_payload(uint16_t word) {
  return type_of(word) == kContinued4 || type_of(word) == kContinued12;
}

/// Returns whether a word is plausible given the state of the check, which is then updated. A run of zeros is not data.
bool check_word(uint16_t word, Check& check, const SensorLimits& limits) {
  if (word == 0 && check.after_frame) return false;
  check.num_zeros = word == 0 ? check.num_zeros + 1 : 0;
  if (check.num_zeros > kMaxZeros) return false;
  check.after_frame = word == kFrameEnd || (check.after_frame && is_payload(word));
  switch (type_of(word)) {
    case kTimeHigh: {
      if (check.time_high == 0xFFFF) return false;
      const uint32_t step = steps(check.time_high, word);
      if (step != 0) return false;
      ++check.heartbeat;
      check.num_rejected = 0;
      return true;
    }
    case kTimeLow: {
      const int low = word & static_cast<int>(kPayloadMask);
      if (!is_plausible_low(check.low, low)) return false;
      check.low = low;
      return true;
    }
    default:
      return is_known(word) && !is_outside(word, limits);
  }
}

/// A TIME_LOW that steps back or far ahead is correct if most of the following ones continue from it rather than from
/// the last one.
Verdict judge_time_low(const uint8_t* words, size_t count, bool ended, const Check& check) {
  const int low = load_le<uint16_t>(words) & static_cast<int>(kPayloadMask);
  const size_t seen = std::min(count, kWindowWords);
  size_t judges = 0, in_favour = 0;
  bool stepped = false;
  for (size_t i = 1; i < seen && judges < kJudges && !stepped; ++i) {
    const auto word = load_le<uint16_t>(words + 2 * i);
    // Words after another coarse time, even that of a restarted clock, say nothing about this one.
    stepped = type_of(word) == kTimeHigh && steps(check.time_high, word) != 0;
    if (type_of(word) != kTimeLow) continue;
    const int next = word & static_cast<int>(kPayloadMask);
    ++judges;
    in_favour += next + kJitterUs >= low && !is_plausible_low(check.low, next) ? 1 : 0;
  }
  if (judges < kJudges && !stepped && seen < kWindowWords && !ended) return Verdict::kNeedMore;
  return 2 * in_favour > judges || judges == 0 ? Verdict::kAccept : Verdict::kReject;
}

}  // namespace

size_t check_scalar(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits) {
  size_t i = 0;
  while (i < count && check_word(load_le<uint16_t>(words + 2 * i), check, limits)) ++i;
  return i;
}

size_t Evt3WordCodec::count_bad(const uint8_t* words, size_t count, size_t enough) {
  size_t bad = 0;
  uint16_t time_high = 0xFFFF;
  int low = -1;
  bool may_continue = true;
  uint32_t num_zeros = 0;
  for (size_t i = 0; i < count && bad < enough; ++i) {
    const auto word = load_le<uint16_t>(words + 2 * i);
    const uint32_t type = type_of(word);
    num_zeros = word == 0 ? num_zeros + 1 : 0;
    bool odd = !is_known(word) || num_zeros > kMaxZeros;
    if (type == kTimeHigh) {
      const uint32_t step = time_high == 0xFFFF ? 0 : steps(time_high, word);
      odd = step >= kHalfCircle;
      if (step != 0) low = -1;
      time_high = word;
    } else if (type == kTimeLow) {
      const int value = word & static_cast<int>(kPayloadMask);
      odd = value + kJitterUs < low;
      low = value;
    } else if (type == kTrigger) {
      odd = (word & 0xFE) != 0;
    } else if (type == kContinued4 || type == kContinued12) {
      odd = !may_continue;
    }
    may_continue = type == kOthers || type == kContinued12 || (may_continue && type == kContinued4);
    bad += odd ? 1 : 0;
  }
  return bad;
}

Violation Evt3WordCodec::classify(const uint8_t* word, const Check& check, const SensorLimits& limits) {
  const auto value = load_le<uint16_t>(word);
  if (!is_known(value) || value == 0) return Violation::kUnknownWord;
  if (is_outside(value, limits)) return Violation::kOutOfRange;
  const bool is_back = type_of(value) == kTimeHigh
                           ? check.time_high != 0xFFFF && steps(check.time_high, value) >= kHalfCircle
                           : (value & static_cast<int>(kPayloadMask)) < check.low;
  return is_back ? Violation::kTimeBackwards : Violation::kTimeJump;
}

std::optional<uint32_t> Evt3WordCodec::coarse_time(const uint8_t* word) {
  const auto value = load_le<uint16_t>(word);
  return type_of(value) == kTimeHigh ? std::optional(value & kPayloadMask) : std::nullopt;
}

std::optional<uint32_t> Evt3WordCodec::coarse_time(const Check& check) {
  return check.time_high == 0xFFFF ? std::nullopt : std::optional(check.time_high & kPayloadMask);
}

size_t Evt3WordCodec::num_padding(const uint8_t* words, size_t count, const Check& check) {
  if (!check.after_frame) return 0;
  size_t zeros = 0;
  while (zeros < count && load_le<uint16_t>(words + 2 * zeros) == 0) ++zeros;
  return zeros;
}

Verdict Evt3WordCodec::judge_time(const uint8_t* words, size_t count, bool ended, const Check& check) {
  return coarse_time(words) ? judge_coarse_time<Evt3WordCodec>(words, count, ended, check)
                            : judge_time_low(words, count, ended, check);
}

void Evt3WordCodec::accept_time(const uint8_t* word, Check& check) {
  const auto value = load_le<uint16_t>(word);
  check.num_zeros = 0;
  if (type_of(value) == kTimeLow) {
    check.low = value & static_cast<int>(kPayloadMask);
    return;
  }
  check.time_high = value;
  check.low = -1;
  check.num_rejected = 0;
  check.after_damage = false;
  check.heartbeat -= 3;
}

void Evt3WordCodec::forget(State& state, Check& check) {
  state.need_time_high = state.need_low = state.need_y = true;
  state.base_x = 0xFFFF;
  check.low = -1;
  check.num_zeros = 0;
  check.after_damage = true;
}

void Evt3WordCodec::drop_word(const uint8_t* word, State& state) {
  switch (type_of(load_le<uint16_t>(word))) {
    case kAddrY:
      state.need_y = true;
      break;
    case kVectBaseX:
      state.base_x = 0xFFFF;
      break;
    case kTimeHigh:
      state.need_time_high = true;
      break;
    case kTimeLow:
      state.need_low = true;
      break;
    default:
      break;
  }
}

}  // namespace e2lf::recordings::evt3
