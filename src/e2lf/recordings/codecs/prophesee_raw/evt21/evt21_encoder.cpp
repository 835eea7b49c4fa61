// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/prophesee_raw/evt21/evt21_encoder.h"

namespace e2lf::recordings::evt21 {

void Encoder::put(uint32_t head, uint32_t mask, WordBuffer& out) const {
  out.put(legacy_ ? head : mask);
  out.put(legacy_ ? mask : head);
}

void Encoder::put_events(const EventColumns& events, size_t begin, size_t end, WordBuffer& out) {
  constexpr uint32_t kBlock = 31;
  for (size_t i = begin; i < end;) {
    const int64_t t = events.t[i];
    const uint32_t base = events.x[i] & ~kBlock;
    clock_.advance(t, [&](uint32_t head) { put(head, 0, out); });
    uint32_t mask = 0;
    size_t last = i;
    do {
      mask |= 1u << (events.x[last] & kBlock);
      ++last;
    } while (last < end && events.t[last] == t && events.y[last] == events.y[i] && events.p[last] == events.p[i] &&
             (events.x[last] & ~kBlock) == base && events.x[last] > events.x[last - 1]);
    put(timed::event_head(events.p[i], t, base, events.y[i]), mask, out);
    i = last;
  }
}

void Encoder::put_trigger(const Trigger& trigger, WordBuffer& out) {
  clock_.advance(trigger.t, [&](uint32_t head) { put(head, 0, out); });
  put(timed::trigger_head(trigger), 0, out);
}

Result<WriterPtr> create(SinkPtr sink, const RecordingInfo& info) {
  RecordingInfo raw = info;
  raw.format = "evt2.1";
  return create_raw_writer<Encoder>(std::move(sink), raw);
}

}  // namespace e2lf::recordings::evt21
