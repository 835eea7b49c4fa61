// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_decoder.h"

#include <algorithm>
#include <bit>

namespace e2lf::recordings::evt3 {
namespace {

constexpr uint16_t kNone = 0xFFFF;

/// Updates the time of the state with a TIME_HIGH word: a different one resets the low part to 0. Backward steps do not
/// occur here.
void take_time_high(uint16_t word, Evt3State& state) {
  if (word == state.time_high) return;
  if (state.time_high == kNone) {
    state.high_us = static_cast<int64_t>(word & kPayloadMask) << 12;
  } else {
    const uint32_t step = (static_cast<uint32_t>(word) - state.time_high) & kPayloadMask;
    state.high_us += int64_t{step < kHalfCircle ? step : 1} << 12;
  }
  state.time_high = word;
  state.low = 0;
}

/// Sets the base of the vectors that follow.
void take_base(uint16_t word, Evt3State& state) {
  state.base_x = static_cast<uint16_t>(word & kCoordinateMask);
  state.base_p = static_cast<uint8_t>((word >> 11) & 1);
}

/// Advances the base after a vector; far outside the sensor it is not changed.
void advance_base(uint32_t bits, Evt3State& state) {
  if (state.base_x < 0x7FFF) state.base_x = static_cast<uint16_t>(state.base_x + bits);
}

/// Returns the part of a vector's mask that is inside the sensor, and advances the base.
uint32_t take_vector(uint32_t mask, uint32_t bits, Evt3State& state, const SensorLimits& limits) {
  if (state.base_x == kNone) {
    state.num_outside += static_cast<uint64_t>(std::popcount(mask));
    return 0;
  }
  const uint32_t base = state.base_x;
  if (base + bits > limits.width) {
    const uint32_t inside = base >= limits.width ? 0 : mask & ((1u << (limits.width - base)) - 1);
    state.num_outside += static_cast<uint64_t>(std::popcount(mask ^ inside));
    mask = inside;
  }
  advance_base(bits, state);
  return mask;
}

/// The time that passes between two TIME_HIGH words that differ.
constexpr int64_t kHighStepUs = int64_t{1} << 12;

uint16_t word_at(const uint8_t* words, size_t i) {
  return load_le<uint16_t>(words + 2 * i);
}

/// Takes what later words depend on from words without triggers and steps of TIME_HIGH, and leaves out their events.
void take_context(const uint8_t* words, size_t count, Evt3State& state) {
  if (const size_t low = find_last(words, count, only(kTimeLow)); low < count) {
    state.low = static_cast<uint16_t>(word_at(words, low) & kPayloadMask);
  }
  if (const size_t row = find_last(words, count, only(kAddrY)); row < count) {
    state.y = static_cast<uint16_t>(word_at(words, row) & kCoordinateMask);
  }
  const size_t base = find_last(words, count, only(kVectBaseX));
  if (base < count) take_base(word_at(words, base), state);
  const size_t vector = find_last(words, count, kVectors);
  if (vector == count) return;
  for (size_t i = base < count ? base + 1 : 0; i <= vector; ++i) {
    const uint32_t type = word_at(words, i) >> 12;
    if (type == kVect12 || type == kVect8) advance_base(type == kVect12 ? 12 : 8, state);
  }
}

constexpr uint32_t kVectorPixels = 32;

uint16_t make_word(Type type, uint32_t payload) {
  return static_cast<uint16_t>((type << 12) | (payload & kPayloadMask));
}

}  // namespace

size_t Evt3WordCodec::decode_scalar(const uint8_t* words, size_t count, State& state, const SensorLimits& limits,
                                    ColumnSink& sink) {
  sink.set_time(time(state));
  for (size_t i = 0; i < count; ++i) {
    const auto word = load_le<uint16_t>(words + 2 * i);
    switch (word >> 12) {
      case kAddrY:
        state.y = static_cast<uint16_t>(word & kCoordinateMask);
        break;
      case kAddrX:
        sink.add(word & kCoordinateMask, state.y, (word >> 11) & 1);
        break;
      case kVectBaseX:
        take_base(word, state);
        break;
      case kVect12:
      case kVect8: {
        const uint32_t bits = word >> 12 == kVect12 ? 12 : 8;
        const uint32_t base = state.base_x;
        const uint32_t mask = take_vector(word & ((1u << bits) - 1), bits, state, limits);
        sink.add_mask(base, state.y, state.base_p, mask);
        break;
      }
      case kTimeLow:
        state.low = static_cast<uint16_t>(word & kPayloadMask);
        sink.set_time(Evt3WordCodec::time(state));
        break;
      case kTimeHigh:
        take_time_high(word, state);
        sink.set_time(Evt3WordCodec::time(state));
        break;
      case kTrigger:
        sink.add_trigger((word >> 8) & 0xF, word & 1);
        break;
      default:
        break;
    }
  }
  return count;
}

void Evt3WordCodec::take_needed(const uint8_t* word, State& state) {
  const auto value = load_le<uint16_t>(word);
  const uint32_t type = value >> 12;
  if (type == kAddrY) state.need_y = false;
  if (type == kTimeLow) state.need_low = false;
  if (type != kTimeHigh) return;
  // Low bits before a new high part do not belong to it.
  if (state.time_high != kNone && value != state.time_high) state.need_low = true;
  state.need_time_high = false;
}

void Evt3WordCodec::count_reports(const uint8_t* words, size_t count, State& state, DecodeSummary& summary) {
  constexpr size_t kBlock = 64;
  for (size_t begin = 0; begin < count; begin += kBlock) {
    const size_t end = std::min(count, begin + kBlock);
    uint32_t num_others = 0;
    for (size_t i = begin; i < end; ++i) num_others += words[2 * i + 1] >> 4 == kOthers ? 1U : 0U;
    if (num_others == 0 && state.report == 0) continue;
    for (size_t i = begin; i < end; ++i) {
      const auto word = load_le<uint16_t>(words + 2 * i);
      const uint32_t type = word >> 12;
      const bool is_payload = type == kContinued12 || type == kContinued4;
      if (!is_payload) state.report = word == kCountIn || word == kCountSent ? word : uint16_t{0};
      if (!is_payload) state.report_bits = 0;
      if (!is_payload || state.report == 0 || state.report_bits > 24) continue;
      const uint64_t part = static_cast<uint64_t>(word & (type == kContinued12 ? 0xFFFU : 0xFU)) << state.report_bits;
      (state.report == kCountIn ? summary.sensor_events_in : summary.sensor_events_sent) += part;
      state.report_bits = static_cast<uint8_t>(state.report_bits + 12);
    }
  }
}

void Evt3WordCodec::extrapolate(State& state, const State& before) {
  // Up to 14 s ahead, or 2 s back.
  constexpr uint32_t kBack = 512;
  const uint32_t ahead = (static_cast<uint32_t>(state.time_high) - before.time_high + kBack) & kPayloadMask;
  state.high_us = before.high_us + ((int64_t{ahead} - kBack) << 12);
  if (state.base_x == kNone) {
    state.base_x = before.base_x;
    state.base_p = before.base_p;
  }
}

size_t find_mark_scalar(const uint8_t* words, size_t count, uint16_t time_high) {
  for (size_t i = 0; i < count; ++i) {
    const uint16_t word = word_at(words, i);
    if (word >> 12 == kTrigger || (word >> 12 == kTimeHigh && word != time_high)) return i;
  }
  return count;
}

size_t find_last_scalar(const uint8_t* words, size_t count, TypeSet types) {
  for (size_t i = count; i-- > 0;) {
    if ((word_at(words, i) & types.mask) == types.value) return i;
  }
  return count;
}

size_t Evt3WordCodec::skip_events(const uint8_t* words, size_t count, State& state, const SensorLimits& limits,
                                  TimeSpan span, ColumnSink& sink) {
  const auto is_inside = [&] {
    return time(state) - kJitterUs >= span.begin_us && state.high_us + kHighStepUs <= span.end_us;
  };
  size_t i = 0;
  while (i < count && is_inside()) {
    const size_t mark = i + find_mark(words + 2 * i, count - i, state.time_high);
    take_context(words + 2 * i, mark - i, state);
    if (mark == count) return count;
    decode_scalar(words + 2 * mark, 1, state, limits, sink);
    i = mark + 1;
  }
  return i;
}

void Encoder::put_time(int64_t t_us, std::vector<uint8_t>& out) {
  if (t_us == t_us_) return;
  clock_.advance(t_us, [&out](uint32_t high) { put_word(out, make_word(kTimeHigh, high)); });
  put_word(out, make_word(kTimeLow, static_cast<uint32_t>(t_us & kPayloadMask)));
  t_us_ = t_us;
}

void Encoder::put_row(const EventColumns& events, size_t begin, size_t end, std::vector<uint8_t>& out) {
  const uint32_t p = events.p[begin];
  uint32_t next_base = 0xFFFF;  // x at which a vector continues without a new base
  for (size_t i = begin; i < end;) {
    const uint32_t x = events.x[i];
    const bool goes_on = x >= next_base && x < next_base + kVectorPixels && next_base + kVectorPixels <= width_;
    const uint32_t base = goes_on ? next_base : std::min(x, width_ - std::min(width_, kVectorPixels));
    uint32_t mask = 0;
    size_t last = i;
    for (; last < end && events.x[last] - base < kVectorPixels; ++last) mask |= 1u << (events.x[last] - base);
    const size_t words = goes_on ? 3 : 4;
    if (last - i <= words || width_ < kVectorPixels) {
      put_word(out, make_word(kAddrX, (p << 11) | x));
      next_base = 0xFFFF;
      ++i;
      continue;
    }
    if (!goes_on) put_word(out, make_word(kVectBaseX, (p << 11) | base));
    put_word(out, make_word(kVect12, mask));
    put_word(out, make_word(kVect12, mask >> 12));
    put_word(out, make_word(kVect8, mask >> 24));
    next_base = base + kVectorPixels;
    i = last;
  }
}

void Encoder::put_events(const EventColumns& events, size_t begin, size_t end, std::vector<uint8_t>& out) {
  for (size_t i = begin; i < end;) {
    put_time(events.t[i], out);
    if (events.y[i] != y_) {
      y_ = events.y[i];
      put_word(out, make_word(kAddrY, y_));
    }
    size_t last = i + 1;
    while (last < end && events.t[last] == events.t[i] && events.y[last] == y_ && events.p[last] == events.p[i] &&
           events.x[last] > events.x[last - 1]) {
      ++last;
    }
    put_row(events, i, last, out);
    i = last;
  }
}

void Encoder::put_trigger(const Trigger& trigger, std::vector<uint8_t>& out) {
  put_time(trigger.t, out);
  put_word(out, make_word(kTrigger, (static_cast<uint32_t>(trigger.id & 0xF) << 8) | (trigger.p & 1u)));
}

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
    // What follows another coarse time, also that of a clock that starts again, cannot judge this word.
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
