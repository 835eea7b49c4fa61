// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "e2lf/recordings/event.h"
#include "e2lf/recordings/io/decode_summary.h"

namespace e2lf::recordings {

inline constexpr size_t kTimeLookAhead = 16;

/// Whether time i of `count` is later than most of its kTimeLookAhead successors, those before `last_us` not counted:
/// then it, and not they, is damaged.
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

/// Sorts out what damage has left unbelievable among events that carry their own full time (DAT, AEDAT4, CSV, npy):
/// an event outside the sensor (kOutOfRange), an event before its predecessor (kTimeBackwards), and an event later than
/// most of its kTimeLookAhead successors or beyond kTimeLimitUs (kTimeJump), so that one flipped bit costs one event
/// and not all that follow. The last kTimeLookAhead events wait for their successors until the next call.
class EventGate {
 public:
  /// The sensor's size in pixels; 0 = unlimited. `record_bytes` turns event numbers into bytes for the summary; 0 =
  /// report the byte where the batch begins.
  EventGate(size_t width, size_t height, size_t record_bytes)
      : width_(width), height_(height), record_bytes_(record_bytes) {}

  /// Appends the events that wait to `events`; newly decoded ones are then appended behind them.
  void release(EventColumns& events);

  /// Removes unbelievable events from [begin, end) of `events` and counts them; `is_end` when no event follows.
  /// `byte` is where the first of those that did not wait is in the file.
  void filter(EventColumns& events, size_t begin, bool is_end, uint64_t byte, DecodeSummary& summary);

  /// Forgets time and waiting events: the reader went elsewhere.
  void reset();

 private:
  [[nodiscard]] bool all_believable(const EventColumns& events, size_t begin) const;
  size_t remove_unbelievable(EventColumns& events, size_t begin, size_t end, uint64_t byte, DecodeSummary& summary);

  size_t width_, height_, record_bytes_;
  int64_t last_us_ = -kTimeLimitUs;
  EventColumns waiting_;
  size_t num_released_ = 0;  ///< of the events that filter() is about to see waited before
};

}  // namespace e2lf::recordings
