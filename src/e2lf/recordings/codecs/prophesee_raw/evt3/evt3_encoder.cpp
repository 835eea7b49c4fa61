// SPDX-License-Identifier: MIT
#include <algorithm>

#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_decoder.h"
#include "e2lf/recordings/codecs/prophesee_raw/evt3/evt3_words.h"

namespace e2lf::recordings::evt3 {
namespace {

constexpr uint32_t kVectorPixels = 32;

uint16_t make_word(Type type, uint32_t payload) {
  return static_cast<uint16_t>((type << 12) | (payload & kPayloadMask));
}

}  // namespace

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

}  // namespace e2lf::recordings::evt3
