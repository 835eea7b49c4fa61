// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "e2lf/capture/measurement/event_images.h"
#include "e2lf/recordings/event.h"

namespace e2lf::cycles {

struct PixelFilterOptions {
  int64_t settle_us = 10000;      ///< how long the events of a pattern change last
  double max_quiet_rate_hz = 50;  ///< a pixel with more events than this while nothing changes is silenced
  double memory_s = 2;            ///< quiet time over which the rate is averaged
};

/// Finds hot and flickering pixels: those that fire while the aperture has long stood still, in the part of a pattern's
/// time beyond settle_us. The light of lamps flickers at about the rate at which patterns change, so that periods do
/// not tell one from the other; quiet time does.
class PixelFilter {
 public:
  PixelFilter(size_t width, size_t height, const PixelFilterOptions& options);

  /// Counts events [begin, end), all of quiet time.
  void add_quiet_events(const recordings::EventColumns& events, size_t begin, size_t end);

  /// Says that this much quiet time has passed.
  void add_quiet_time(int64_t duration_us);

  /// Sets the images to 0 at the pixels that are too loud.
  void apply(capture::EventImages& images) const;

  [[nodiscard]] size_t num_silenced() const { return silenced_.size(); }

 private:
  PixelFilterOptions options_;
  size_t width_, height_;
  std::vector<float> counts_;
  double quiet_s_ = 0;
  std::vector<size_t> silenced_;  ///< pixel numbers
};

}  // namespace e2lf::cycles
