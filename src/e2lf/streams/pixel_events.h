// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "e2lf/recordings/event.h"
#include "e2lf/streams/light_segment.h"

namespace e2lf::streams {

/// An event of a segment in eight bytes: microseconds since the beginning of the segment (31 bits), pixel number (32)
/// and sign (1).
class PixelEvent {
 public:
  PixelEvent() = default;
  PixelEvent(uint32_t offset_us, uint32_t pixel, bool is_on)
      : bits_(uint64_t{offset_us} << 33 | uint64_t{pixel} << 1 | uint64_t{is_on}) {}

  [[nodiscard]] uint32_t offset_us() const { return static_cast<uint32_t>(bits_ >> 33); }
  [[nodiscard]] uint32_t pixel() const { return static_cast<uint32_t>(bits_ >> 1); }
  [[nodiscard]] bool is_on() const { return (bits_ & 1) != 0; }

 private:
  uint64_t bits_ = 0;
};

/// Collects the events of one pixel after another.
class PixelEventSink {
 public:
  PixelEventSink(std::vector<PixelEvent>& events, int64_t duration_us)
      : events_(&events), last_us_(static_cast<double>(duration_us - 1)) {}

  /// Adds an event `offset_us` after the beginning of the segment. The time is rounded down and clamped to the segment.
  void add(double offset_us, size_t pixel, bool is_on) {
    const double clamped = offset_us > 0 ? (offset_us < last_us_ ? offset_us : last_us_) : 0;
    events_->emplace_back(static_cast<uint32_t>(clamped), static_cast<uint32_t>(pixel), is_on);
  }

 private:
  std::vector<PixelEvent>* events_;
  double last_us_;
};

/// Appends the events of one segment, given as consecutive parts, to `columns` in order of time. Events of the same
/// time keep their order.
void append_in_time(const std::vector<std::vector<PixelEvent>>& parts, const LightSegment& segment, size_t width,
                    recordings::EventColumns& columns);

}  // namespace e2lf::streams
