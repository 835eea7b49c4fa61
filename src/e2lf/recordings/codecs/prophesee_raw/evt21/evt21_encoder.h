// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_writer.h"
#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_clock.h"

namespace e2lf::recordings::evt21 {

/// Encodes events and triggers as EVT2.1 words (the Encoder of RawWriter): one word for a run of events with the same
/// time, row, polarity and block of 32 pixels. Words are little-endian, or have their halves in "legacy" order if the
/// key `endianness` of the info says so.
class Encoder {
 public:
  explicit Encoder(const RecordingInfo& info) : legacy_(info.find("endianness") == "legacy") {}
  static constexpr int64_t kMaxFirstUs = timed::Clock::kMaxFirstUs;
  static constexpr int64_t kMaxPauseUs = timed::Clock::kMaxFirstUs;
  static constexpr uint16_t kMaxTriggerId = 31;

  void put_events(const EventColumns& events, size_t begin, size_t end, WordBuffer& out);
  void put_trigger(const Trigger& trigger, WordBuffer& out);

 private:
  void put(uint32_t head, uint32_t mask, WordBuffer& out) const;

  bool legacy_;
  timed::Clock clock_;
};

/// Creates a RAW recording of EVT2.1 words.
[[nodiscard]] Result<WriterPtr> create(SinkPtr sink, const RecordingInfo& info);

}  // namespace e2lf::recordings::evt21
