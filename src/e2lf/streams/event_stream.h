// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/recordings/event.h"
#include "e2lf/streams/stream_pixels.h"

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

/// Simulates the individual events of an event camera from the light over time. Each event occurs at the microsecond in
/// which the signal of the pixel crosses its threshold. The state of the pixels (references, thresholds and noise) is
/// carried from segment to segment and thus from cycle to cycle. The result is identical, event for event, for any
/// number of threads.
///
///   auto stream = EventStream::create(options, height, width);
///   while (...) stream->advance(segment, events);
class EventStream {
 public:
  /// Fails as validate(StreamOptions) does, and with kShape (no pixels, or more than 65,536 in a row or column).
  [[nodiscard]] static Result<EventStream> create(const StreamOptions& options, size_t height, size_t width);

  /// Sets the pixels to the steady state for the light `from` of the segment, without events. It may only be called
  /// before the first segment, which begins with this light.
  void rest(const LightSegment& segment);

  /// Appends the events of the next segment, in order of time. Without rest(), the pixels begin in the steady state for
  /// the light `from` of the first segment. Segments must be contiguous and shorter than 35 minutes, or the contract is
  /// broken. With a readout limit, events may come after the end of the segment, but never after events of the next
  /// one.
  void advance(const LightSegment& segment, recordings::EventColumns& events);

  [[nodiscard]] uint64_t lost_events() const {
    return readout_.lost();
  }  ///< number of events lost to the readout limit

 private:
  EventStream(const StreamOptions& options, size_t height, size_t width);
  [[nodiscard]] std::unique_ptr<StreamPixels> make_pixels(const LightSegment& first) const;

  StreamOptions options_;
  size_t height_, width_;
  int64_t now_us_ = 0;
  std::unique_ptr<StreamPixels> pixels_;
  std::vector<std::vector<PixelEvent>> parts_;
  ReadoutQueue readout_;
};

}  // namespace e2lf::streams
