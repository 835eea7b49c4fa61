// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "e2lf/capture/profile/sensor_profile.h"

namespace e2lf::recon {

/// How much the counts of a still scene vary from cycle to cycle with a sensor. A count is the change of the log
/// intensity, with the noise at both ends, in thresholds, truncated toward zero. Where little changes, the noise hardly
/// ever reaches a threshold, so that the counts vary far less than the log intensity.
class CountNoise {
 public:
  explicit CountNoise(const capture::SensorProfile& camera);

  /// Where the transitions before have led a pixel, at first to black.
  struct PixelLevel {
    float level = 0;       ///< above black, in events
    float variance = -1;   ///< of the log intensity there, in squared thresholds; negative at the beginning of a cycle
    bool is_below = true;  ///< the last count was positive, so that the reference is below the intensity
  };

  /// Returns the variance of the count of the next transition, whose mean is `count`, in squared events, and proceeds
  /// to its end.
  [[nodiscard]] float next(float count, PixelLevel& state) const;

 private:
  [[nodiscard]] float truncated(float variance, float count, const PixelLevel& state) const;

  bool is_pixel_;
  float threshold_on_, threshold_off_;  ///< natural logarithm
  float threshold_spread_;              ///< relative standard deviation from one transition to the next
  float reference_variance_;            ///< of the reference at the beginning of a cycle, in squared thresholds
  std::vector<float> log_variances_;    ///< of the log intensity, by the level
  /// Variance of a truncated count by that of the noise and by its mean: of a reference at the intensity, and of one
  /// whose distance below it is uniform in [0, 1).
  std::vector<float> at_reference_, above_reference_;
};

}  // namespace e2lf::recon
