// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "e2lf/streams/light_segment.h"
#include "e2lf/streams/pixel_events.h"
#include "e2lf/streams/stream_options.h"

namespace e2lf::streams {

/// Pixels that are followed together.
inline constexpr size_t kPartPixels = 4096;

/// The pixels of a sensor with all that they remember from segment to segment.
class StreamPixels {
 public:
  virtual ~StreamPixels() = default;

  /// Follows every pixel through a segment. parts[i] gets the events of pixels [i, i + 1) * kPartPixels: pixel after
  /// pixel or moment after moment, those of one pixel in order of time.
  virtual void advance(const LightSegment& segment, std::vector<std::vector<PixelEvent>>& parts) = 0;
};

/// Pixels that do not depend on each other: each goes through the whole segment by itself.
class SinglePixels : public StreamPixels {
 public:
  void advance(const LightSegment& segment, std::vector<std::vector<PixelEvent>>& parts) override;

 protected:
  explicit SinglePixels(size_t count) : count_(count) {}
  [[nodiscard]] size_t count() const { return count_; }

  /// The pixels [begin, end) of one part.
  virtual void follow(const LightSegment& segment, size_t begin, size_t end, PixelEventSink events) = 0;

 private:
  size_t count_;
};

/// Pixels that have seen the light of `first` for ever.
[[nodiscard]] std::unique_ptr<StreamPixels> make_step_pixels(const StreamOptions& options, const LightSegment& first);
[[nodiscard]] std::unique_ptr<StreamPixels> make_esim_pixels(const StreamOptions& options, const LightSegment& first);
[[nodiscard]] std::unique_ptr<StreamPixels> make_v2e_pixels(const StreamOptions& options, const LightSegment& first);
[[nodiscard]] std::unique_ptr<StreamPixels> make_physical_pixels(const StreamOptions& options,
                                                                 const LightSegment& first);
/// The same in plain scalar arithmetic of the C library: what the fast ones are tested against and compared with.
[[nodiscard]] std::unique_ptr<StreamPixels> make_reference_physical_pixels(const StreamOptions& options,
                                                                           const LightSegment& first);

}  // namespace e2lf::streams
