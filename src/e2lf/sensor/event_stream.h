// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

#include "e2lf/events/event.h"
#include "e2lf/events/event_images.h"

namespace e2lf::sensor {

struct EventStreamOptions {
  int64_t start_us = 0;        ///< when the first pattern of the first cycle appears
  int64_t pattern_us = 10000;  ///< how long each pattern is shown
  int64_t settle_us = 4000;    ///< from a pattern change to its last event; 1..pattern_us
  uint64_t seed = 0;           ///< of the times within a transition
};

/// A camera's recording of cycles shown one after another, sorted by time: pattern n of cycle c appears at
/// start_us + (c N + n) pattern_us with a rising edge on trigger input 0. The events of a pixel in a transition come at
/// settle_us ((j + u) / count)^2, j = 0.. count - 1, u random per pixel: dense at first, as the answer to a step is.
/// Showing pattern 1 again takes back every event of the cycle (one transition whose counts are minus their sums), also
/// after the last cycle. All cycles must have one size of at most 65536 pixels a side, and there must be at least one;
/// else the contract is broken.
[[nodiscard]] events::EventBatch event_stream(std::span<const events::EventImages> cycles,
                                              const EventStreamOptions& options = {});

}  // namespace e2lf::sensor
