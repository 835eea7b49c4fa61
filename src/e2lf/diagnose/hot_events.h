// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>

#include "e2lf/capture/measurement/hot_pixels.h"
#include "e2lf/diagnose/finding.h"
#include "e2lf/recordings/event.h"

namespace e2lf::diagnose {

/// Returns whether a finding names the hot pixels: they are 0.03 % of all pixels or more, and at least four.
[[nodiscard]] bool are_many_hot(size_t hot, size_t pixels);

/// Finds hot pixels in a recording that is not divided into cycles: slices of two events per pixel take the place of
/// the transitions of capture::hot_pixels(). Events after the eighth slice are not counted.
class HotEvents {
 public:
  /// The size of the sensor, px. Without a size, and beyond 4 million pixels, no hot pixel is found.
  HotEvents(size_t height, size_t width);

  void add(const recordings::EventColumns& events);

  /// Returns the number of hot pixels; 0 while fewer than three slices are complete, or unless are_many_hot().
  [[nodiscard]] size_t count() const;
  /// Returns the finding that there are some.
  [[nodiscard]] std::optional<Finding> finding() const;

 private:
  size_t pixels_;
  size_t in_slice_ = 0;      ///< events in the last slice
  capture::CountSums sums_;  ///< of one cycle, whose transitions are the slices
};

}  // namespace e2lf::diagnose
