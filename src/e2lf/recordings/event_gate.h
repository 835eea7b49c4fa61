// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "e2lf/recordings/event.h"
#include "e2lf/recordings/io/decode_summary.h"

namespace e2lf::recordings {

inline constexpr size_t kTimeLookAhead = 16;

/// Returns true if time i of `count` is later than most of its next kTimeLookAhead successors, not counting those
/// before `last_us`. In this case, it is damaged, and not its successors.
template <typename TimeAt>
[[nodiscard]] bool is_ahead_of_successors(size_t i, size_t count, int64_t last_us, const TimeAt& time_at) {
  const int64_t t = time_at(i);
  const size_t end = i + 1 + kTimeLookAhead < count ? i + 1 + kTimeLookAhead : count;
  size_t earlier = 0, counted = 0;
  for (size_t j = i + 1; j < end; ++j) {
    const int64_t successor = time_at(j);
    counted += successor >= last_us;
    earlier += successor >= last_us && successor < t;
  }
  return 2 * earlier > counted;
}

/// Removes implausible events from formats whose events contain their full time (DAT, AEDAT4, CSV, npy): events outside
/// the sensor (kOutOfRange), events before their predecessor (kTimeBackwards), and events later than most of their next
/// kTimeLookAhead successors or beyond kTimeLimitUs (kTimeJump). A flipped bit therefore removes one event and not all
/// that follow. The last kTimeLookAhead events are withheld until the next call provides their successors.
class EventGate {
 public:
  /// `width` and `height` are the size of the sensor in px; 0 = unlimited. `record_bytes` is the size of an event in
  /// the file, from which the summary computes positions; 0 = report the position of the batch.
  EventGate(size_t width, size_t height, size_t record_bytes)
      : width_(width), height_(height), record_bytes_(record_bytes) {}

  /// Appends the withheld events to `events`; the caller appends newly decoded ones after them.
  void release(EventColumns& events);

  /// Removes implausible events from `begin` to the end of `events` and counts them. `is_end` states that no event
  /// follows. `byte` is the position in the file of the first event that was not withheld.
  void filter(EventColumns& events, size_t begin, bool is_end, uint64_t byte, DecodeSummary& summary);

  /// Discards the last time and the withheld events, after the reader has moved to another position.
  void reset();

 private:
  [[nodiscard]] bool all_believable(const EventColumns& events, size_t begin) const;
  size_t remove_unbelievable(EventColumns& events, size_t begin, size_t end, uint64_t byte, DecodeSummary& summary);

  size_t width_, height_, record_bytes_;
  int64_t last_us_ = -kTimeLimitUs;
  EventColumns waiting_;
  size_t num_released_ = 0;  ///< number of withheld events among those of the next filter()
};

}  // namespace e2lf::recordings
