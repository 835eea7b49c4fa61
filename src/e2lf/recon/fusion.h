// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "e2lf/base/strided_view.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/profile/sensor_profile.h"

namespace e2lf::recon {

/// The largest share of the windows of a still scene in which a new cycle seems to show a change, with the sensors
/// `paper` and `evk4-lcos`. Each false alarm makes 14x14 px start again.
inline constexpr double kFalseAlarmRate = 1e-3;

/// The largest number of cycles in a mean.
inline constexpr size_t kMostFusedCycles = 64;

/// Fuses the cycles of a scene of which parts move: each pixel holds the mean of the cycles since the scene last
/// changed there.
///
/// A change is found by the residuals of the counts of the new cycle from the means, summed over blocks of 2x2 px,
/// which show fine texture that moved, and over windows of 6x6 px, which show weak texture. If nothing moved, the
/// squares of these sums, in units of the variance that the sensor profile predicts for the level there, have a mean of
/// 1 over the transitions and over 6x6 px, and approximately a chi-squared distribution. Where one of the means is too
/// large for it, and within the reach of the windows, the pixels start again with the new cycle.
class CycleFusion {
 public:
  /// Prepares the fusion of event images, [transition, y, x], of lit transitions or of a whole cycle, from a camera
  /// with this profile. Means are over up to `most_cycles`, 1 to kMostFusedCycles; then each new cycle has the weight 1
  /// / most_cycles.
  CycleFusion(const capture::SensorProfile& camera, size_t most_cycles);

  /// Adds the event images of the next cycle. Another size than before starts everything again.
  void add(const PlanesView<const int16_t>& cycle);

  /// Returns the means, which saturate at 16 bits, and the effective number of cycles: the variance of the noise of one
  /// cycle divided by that of the mean. Exponential means reach 2 most_cycles - 1.
  [[nodiscard]] const capture::FusedCycles& fused() const { return fused_; }
  [[nodiscard]] size_t most_cycles() const { return most_cycles_; }
  /// Returns the share of the pixels that started again with the last cycle; 1 for the first one.
  [[nodiscard]] double changed() const { return changed_; }

 private:
  void restart(const PlanesView<const int16_t>& cycle);
  void compare(const PlanesView<const int16_t>& cycle);
  void compare_row(const PlanesView<const int16_t>& cycle, size_t block_y);
  void find_changes();
  void update(const PlanesView<const int16_t>& cycle);
  void update_row(const PlanesView<const int16_t>& cycle, size_t block_y);
  /// Returns what the noise at the end of a transition adds to the variance of its count, in squared events; the level
  /// above black and the count are in capture::kFusedUnits.
  [[nodiscard]] float count_variance(int level, int count) const;

  size_t most_cycles_;
  float threshold_on_ = 0, threshold_off_ = 0;  ///< natural logarithm
  float threshold_spread_ = 0;                  ///< relative standard deviation from one transition to the next
  float rounding_ = 0;                          ///< variance of a rounded count
  float reference_variance_;                    ///< of the reference at the beginning of a cycle
  std::vector<float> variances_;                ///< of the log intensity, by the level in quarters of an event
  std::vector<float> effective_;                ///< number of cycles, by the number of cycles added
  capture::FusedCycles fused_;
  std::vector<uint16_t> added_;  ///< number of cycles since the last change, up to a limit; [block_y, block_x]
  Planes<float> residuals_,
      expected_;  ///< sums of the residuals and of their variances, [transition, block_y, block_x]
  std::vector<float> of_blocks_, of_sums_;  ///< both statistics, [block_y, block_x]
  std::vector<uint8_t> is_changed_;         ///< [block_y, block_x]
  double changed_ = 0;
};

}  // namespace e2lf::recon
