// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "e2lf/recordings/event.h"
#include "e2lf/streams/stream_options.h"

namespace e2lf::streams {

/// The readout of a sensor: events leave one after another, at least 1 / events_per_s apart, and get the time at which
/// they leave. An event that would wait longer than longest_us is lost.
class ReadoutQueue {
 public:
  explicit ReadoutQueue(const ReadoutLimit& limit)
      : interval_us_(limit.events_per_s > 0 ? 1e6 / limit.events_per_s : 0), longest_us_(limit.longest_us) {}

  /// Passes the events from `begin` on through the queue. They must be in order of time and not earlier than the
  /// previous ones.
  void pass(recordings::EventColumns& events, size_t begin);

  [[nodiscard]] uint64_t lost() const { return lost_; }

 private:
  double interval_us_, longest_us_;
  double free_us_ = -1e300;  ///< the time at which the next event can leave
  uint64_t lost_ = 0;
};

}  // namespace e2lf::streams
