// SPDX-License-Identifier: MIT
#include <algorithm>

#include "e2lf/events/evt3/evt3_decoder.h"

namespace e2lf::events::evt3 {
namespace {

uint32_t type_of(uint16_t word) {
  return word >> 12;
}

bool is_known(uint16_t word) {
  return ((kKnownTypes >> type_of(word)) & 1) != 0 || word == kPadding;
}

/// How far `to` is ahead of `from` on the 12-bit circle of TIME_HIGH words.
uint32_t steps(uint16_t from, uint16_t to) {
  return (static_cast<uint32_t>(to) - from) & kPayloadMask;
}

bool is_outside(uint16_t word, const SensorLimits& limits) {
  const uint32_t type = type_of(word);
  const uint32_t coordinate = word & kCoordinateMask;
  if (type == kAddrY) return coordinate >= limits.height;
  return (type == kAddrX || type == kVectBaseX) && coordinate >= limits.width;
}

/// Whether one word is plausible after what the check knows; takes it over if so. A run of zeros is no data.
bool check_word(uint16_t word, Check& check, const SensorLimits& limits) {
  if (word == 0 && check.after_zero) return false;
  check.after_zero = word == 0;
  switch (type_of(word)) {
    case kTimeHigh: {
      if (check.time_high == 0xFFFF) return false;
      const uint32_t step = steps(check.time_high, word);
      if (step > 1) return false;
      ++check.num_time_high;
      check.num_rejected = 0;
      if (step == 0) return true;
      ++check.num_time_steps;
      check.time_high = word;
      check.low = -1;
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

/// Another word of the given type behind `words[0]`, before TIME_HIGH changes; `count` when there is none.
size_t find_next(const uint8_t* words, size_t count, uint32_t type) {
  for (size_t i = 1; i < count; ++i) {
    const auto word = load_le<uint16_t>(words + 2 * i);
    if (type_of(word) == type) return i;
  }
  return count;
}

Verdict judge_time_high(const uint8_t* words, size_t count, bool ended, const Check& check) {
  const auto word = load_le<uint16_t>(words);
  const size_t next = find_next(words, std::min(count, kJudgeWords), kTimeHigh);
  if (next == std::min(count, kJudgeWords)) {
    if (count < kJudgeWords && !ended) return Verdict::kNeedMore;
    const bool ahead = check.time_high == 0xFFFF || steps(check.time_high, word) < 2048;
    return ahead ? Verdict::kAccept : Verdict::kReject;
  }
  const auto following = load_le<uint16_t>(words + 2 * next);
  const uint32_t from_this = steps(word, following);
  if (check.time_high == 0xFFFF) return from_this < 2048 ? Verdict::kAccept : Verdict::kReject;
  if (check.num_rejected >= kClockRestart) return from_this <= 1 ? Verdict::kAccept : Verdict::kReject;
  if (steps(check.time_high, word) >= 2048) return Verdict::kReject;
  return from_this <= steps(check.time_high, following) ? Verdict::kAccept : Verdict::kReject;
}

/// A TIME_LOW that steps back or far ahead is right if the next one goes on from it.
Verdict judge_time_low(const uint8_t* words, size_t count, bool ended, const Check& check) {
  const int low = load_le<uint16_t>(words) & static_cast<int>(kPayloadMask);
  const size_t seen = std::min(count, kWindowWords);
  for (size_t i = 1; i < seen; ++i) {
    const auto word = load_le<uint16_t>(words + 2 * i);
    if (type_of(word) == kTimeHigh && word != check.time_high) return Verdict::kAccept;
    if (type_of(word) != kTimeLow) continue;
    const int next = word & static_cast<int>(kPayloadMask);
    const bool follows_last = next + kJitterUs >= check.low && next <= check.low + kLongStepUs;
    const bool follows_this = next + kJitterUs >= low;
    return follows_this && !(follows_last && low > next) ? Verdict::kAccept : Verdict::kReject;
  }
  return seen < kWindowWords && !ended ? Verdict::kNeedMore : Verdict::kAccept;
}

}  // namespace

size_t check_scalar(const uint8_t* words, size_t count, Check& check, const SensorLimits& limits) {
  size_t i = 0;
  while (i < count && check_word(load_le<uint16_t>(words + 2 * i), check, limits)) ++i;
  return i;
}

size_t Codec::count_bad(const uint8_t* words, size_t count, size_t enough, const SensorLimits& limits) {
  size_t bad = 0;
  uint16_t time_high = 0xFFFF;
  int low = -1;
  bool may_continue = true;
  bool after_zero = false;
  for (size_t i = 0; i < count && bad < enough; ++i) {
    const auto word = load_le<uint16_t>(words + 2 * i);
    const uint32_t type = type_of(word);
    bool odd = !is_known(word) || is_outside(word, limits) || (word == 0 && after_zero);
    after_zero = word == 0;
    if (type == kTimeHigh) {
      const uint32_t step = time_high == 0xFFFF ? 0 : steps(time_high, word);
      odd = step >= 2048;
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

Suspicion Codec::suspicion(const uint8_t* word, const Check& check, const SensorLimits& limits) {
  const auto value = load_le<uint16_t>(word);
  if (!is_known(value) || value == 0) return Suspicion::kUnknown;
  if (is_outside(value, limits)) return Suspicion::kRange;
  const bool is_back = type_of(value) == kTimeHigh ? check.time_high != 0xFFFF && steps(check.time_high, value) >= 2048
                                                   : (value & static_cast<int>(kPayloadMask)) < check.low;
  return is_back ? Suspicion::kTimeBack : Suspicion::kTimeAhead;
}

int64_t Codec::step_us(const uint8_t* word, const Check& check) {
  const auto value = load_le<uint16_t>(word);
  if (type_of(value) != kTimeHigh || check.time_high == 0xFFFF) return 0;
  return static_cast<int64_t>(steps(check.time_high, value)) << 12;
}

Verdict Codec::judge_time(const uint8_t* words, size_t count, bool ended, const Check& check) {
  const bool is_high = type_of(load_le<uint16_t>(words)) == kTimeHigh;
  return is_high ? judge_time_high(words, count, ended, check) : judge_time_low(words, count, ended, check);
}

void Codec::accept_time(const uint8_t* word, Check& check) {
  const auto value = load_le<uint16_t>(word);
  check.after_zero = false;
  if (type_of(value) == kTimeLow) {
    check.low = value & static_cast<int>(kPayloadMask);
    return;
  }
  check.time_high = value;
  check.low = -1;
  check.num_rejected = 0;
  ++check.num_time_high;
  ++check.num_time_steps;
}

void Codec::reject_time(const uint8_t* word, Check& check) {
  if (type_of(load_le<uint16_t>(word)) == kTimeHigh) ++check.num_rejected;
}

void Codec::forget(State& state, Check& check) {
  state.need_time_high = state.need_low = state.need_y = true;
  state.base_x = 0xFFFF;
  check.low = -1;
  check.after_zero = false;
}

void Codec::drop_word(const uint8_t* word, State& state) {
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

}  // namespace e2lf::events::evt3
