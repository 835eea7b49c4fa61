// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "e2lf/streams/light_segment.h"
#include "e2lf/streams/pixel_events.h"
#include "e2lf/streams/stream_options.h"

namespace e2lf::streams {

/// The number of pixels that are processed together.
inline constexpr size_t kPartPixels = 4096;

/// The pixels of a sensor with their state, which is carried from segment to segment.
class StreamPixels {
 public:
  virtual ~StreamPixels() = default;

  /// Follows every pixel through a segment. parts[i] receives the events of pixels [i, i + 1) * kPartPixels, ordered by
  /// pixel or by time; those of one pixel are in order of time.
  virtual void advance(const LightSegment& segment, std::vector<std::vector<PixelEvent>>& parts) = 0;
};

/// Pixels that are independent of each other: each is followed through the whole segment by itself.
class SinglePixels : public StreamPixels {
 public:
  void advance(const LightSegment& segment, std::vector<std::vector<PixelEvent>>& parts) override;

 protected:
  explicit SinglePixels(size_t count) : count_(count) {}
  [[nodiscard]] size_t count() const { return count_; }

  /// Follows the pixels [begin, end) of one part.
  virtual void follow(const LightSegment& segment, size_t begin, size_t end, PixelEventSink events) = 0;

 private:
  size_t count_;
};

/// Make pixels in the steady state for the light of `first`.
[[nodiscard]] std::unique_ptr<StreamPixels> make_step_pixels(const StreamOptions& options, const LightSegment& first);
[[nodiscard]] std::unique_ptr<StreamPixels> make_esim_pixels(const StreamOptions& options, const LightSegment& first);
[[nodiscard]] std::unique_ptr<StreamPixels> make_v2e_pixels(const StreamOptions& options, const LightSegment& first);
[[nodiscard]] std::unique_ptr<StreamPixels> make_physical_pixels(const StreamOptions& options,
                                                                 const LightSegment& first);
/// Makes the same pixels with plain scalar arithmetic of the C library, as the reference for the fast ones.
[[nodiscard]] std::unique_ptr<StreamPixels> make_reference_physical_pixels(const StreamOptions& options,
                                                                           const LightSegment& first);

}  // namespace e2lf::streams
