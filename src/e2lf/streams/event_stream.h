// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/recordings/event.h"
#include "e2lf/streams/light_segment.h"
#include "e2lf/streams/readout_queue.h"
#include "e2lf/streams/stream_pixels.h"

namespace e2lf::streams {

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

  [[nodiscard]] uint64_t lost_events() const { return readout_.lost(); }  ///< by the readout limit

  /// Uses the scalar reference implementation if there is one. It must be called before the first segment.
  void use_reference() { uses_reference_ = true; }

 private:
  EventStream(const StreamOptions& options, size_t height, size_t width);
  [[nodiscard]] std::unique_ptr<StreamPixels> make_pixels(const LightSegment& first) const;

  StreamOptions options_;
  size_t height_, width_;
  bool uses_reference_ = false;
  int64_t now_us_ = 0;
  std::unique_ptr<StreamPixels> pixels_;
  std::vector<std::vector<PixelEvent>> parts_;
  ReadoutQueue readout_;
};

}  // namespace e2lf::streams
