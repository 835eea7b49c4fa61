// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "e2lf/recordings/codecs/prophesee_raw/stream/raw_writer.h"

namespace e2lf::recordings::evt3 {

/// Encodes events and triggers as EVT3 words (the Encoder of RawWriter). Runs of events in one row with the same
/// polarity become vectors (always a base and 12, 12 and 8 pixels, which every reader supports) if this is shorter.
/// TIME_HIGH is written at every step, and repeated after 16 us.
class Encoder {
 public:
  static constexpr const char* kFormat = "evt3";
  explicit Encoder(const RecordingInfo& info) : width_(static_cast<uint32_t>(info.width)) {}

  /// Later starts would need too many words that only count the loops of the 24-bit clock.
  static constexpr int64_t kMaxFirstUs = int64_t{1} << 41;

  /// Pauses are filled with time words, 2 bytes per 4 ms: 32 MiB for the longest, 19 hours.
  static constexpr int64_t kMaxPauseUs = int64_t{1} << 36;
  static constexpr uint16_t kMaxTriggerId = 15;

  void put_events(const EventColumns& events, size_t begin, size_t end, WordBuffer& out);
  void put_trigger(const Trigger& trigger, WordBuffer& out);

 private:
  void put_time(int64_t t_us, WordBuffer& out);
  void put_time_high(int64_t high, WordBuffer& out);
  void put_row(const EventColumns& events, size_t begin, size_t end, WordBuffer& out);

  uint32_t width_;
  int64_t high_ = -1;       ///< t >> 12 of the last TIME_HIGH
  int64_t t_us_ = -1;       ///< the time after the words so far
  int64_t high_at_us_ = 0;  ///< when the last TIME_HIGH was written
  uint32_t y_ = 0xFFFF;
};

}  // namespace e2lf::recordings::evt3
