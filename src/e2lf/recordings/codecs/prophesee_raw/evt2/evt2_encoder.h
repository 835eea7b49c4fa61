// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_writer.h"
#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_clock.h"

namespace e2lf::recordings::evt2 {

/// Encodes events and triggers as EVT2 words (the Encoder of RawWriter).
class Encoder {
 public:
  explicit Encoder(const RecordingInfo&) {}
  static constexpr int64_t kMaxFirstUs = timed::Clock::kMaxFirstUs;
  static constexpr int64_t kMaxPauseUs = timed::Clock::kMaxFirstUs;
  static constexpr uint16_t kMaxTriggerId = 31;

  void put_events(const EventColumns& events, size_t begin, size_t end, WordBuffer& out);
  void put_trigger(const Trigger& trigger, WordBuffer& out);

 private:
  timed::Clock clock_;
};

/// Creates a RAW recording of EVT2 words.
[[nodiscard]] Result<WriterPtr> create(SinkPtr sink, const RecordingInfo& info);

}  // namespace e2lf::recordings::evt2
