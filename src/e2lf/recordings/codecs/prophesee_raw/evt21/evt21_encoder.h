// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_writer.h"
#include "e2lf/recordings/codecs/prophesee_raw/timed/timed_clock.h"

namespace e2lf::recordings::evt21 {

/// Makes EVT2.1 words of events and triggers (the Encoder of RawWriter): one word for a run of events of one time, row,
/// polarity and block of 32 pixels. Plain little-endian words, or halves in "legacy" order where info says so by the
/// key `endianness`.
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

/// Writes a RAW recording of EVT2.1 words.
[[nodiscard]] Result<std::unique_ptr<RecordingWriter>> create(std::unique_ptr<ByteSink> sink,
                                                              const RecordingInfo& info);

}  // namespace e2lf::recordings::evt21
