// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "e2lf/recordings/event.h"
#include "e2lf/streams/light_segment.h"
#include "e2lf/streams/readout_queue.h"
#include "e2lf/streams/stream_pixels.h"

namespace e2lf::streams {

/// The events of an event camera one by one, as light goes on: each at the microsecond in which the pixel's signal
/// crosses its threshold. What pixels remember, their references, thresholds and noise, is carried from segment to
/// segment and so from cycle to cycle. The same, event for event, for any number of threads.
///
///   auto stream = EventStream::create(options, height, width);
///   while (...) stream->advance(segment, events);
class EventStream {
 public:
  /// Fails as validate(StreamOptions) and with kShape (no pixels, or more than 65,536 in a row or column).
  [[nodiscard]] static Result<EventStream> create(const StreamOptions& options, size_t height, size_t width);

  /// Lets pixels have seen the segment's `from` for ever, without events; before the first segment, which begins with
  /// it.
  void rest(const LightSegment& segment);

  /// Appends the events of the next segment, in order of time. Without rest() pixels have seen the `from` of the
  /// first for ever. Segments follow on each other without gaps, and are shorter than 35 minutes; else the contract is
  /// broken. With a readout limit events may come after the segment's end, never after events of the next one.
  void advance(const LightSegment& segment, recordings::EventColumns& events);

  [[nodiscard]] uint64_t lost_events() const { return readout_.lost(); }  ///< to the readout limit

  /// Uses the scalar reference where there is one; before the first segment.
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
