// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/prophesee_raw/evt2/evt2_encoder.h"

namespace e2lf::recordings::evt2 {

void Encoder::put_events(const EventColumns& events, size_t begin, size_t end, WordBuffer& out) {
  for (size_t i = begin; i < end; ++i) {
    clock_.advance(events.t[i], [&out](uint32_t head) { out.put(head); });
    out.put(timed::event_head(events.p[i], events.t[i], events.x[i], events.y[i]));
  }
}

void Encoder::put_trigger(const Trigger& trigger, WordBuffer& out) {
  clock_.advance(trigger.t, [&out](uint32_t head) { out.put(head); });
  out.put(timed::trigger_head(trigger));
}

Result<WriterPtr> create(SinkPtr sink, const RecordingInfo& info) {
  RecordingInfo raw = info;
  raw.format = "evt2";
  return create_raw_writer<Encoder>(std::move(sink), raw);
}

}  // namespace e2lf::recordings::evt2
