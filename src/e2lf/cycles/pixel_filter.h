// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/recordings/event.h"

namespace e2lf::cycles {

struct PixelFilterOptions {
  int64_t settle_us = 10000;      ///< duration of the events of a pattern change
  double max_quiet_rate_hz = 50;  ///< limit while nothing changes; pixels with more events are silenced
  double memory_s = 2;            ///< quiet time over which the rate is averaged
};

/// Finds hot and flickering pixels by their events while the aperture has been static for a long time, i.e. in the part
/// of the time of a pattern after settle_us. The light of lamps flickers at about the rate of the patterns, so the
/// period does not distinguish them, but the quiet time does.
class PixelFilter {
 public:
  PixelFilter(size_t width, size_t height, const PixelFilterOptions& options);

  /// Counts events [begin, end), all of which must lie in quiet time.
  void add_quiet_events(const recordings::EventColumns& events, size_t begin, size_t end);

  /// Adds this much quiet time.
  void add_quiet_time(int64_t duration_us);

  /// Sets the images to 0 at the pixels with too many quiet events.
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
