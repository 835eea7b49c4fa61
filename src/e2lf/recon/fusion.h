// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "e2lf/base/strided_view.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/recon/count_noise.h"

namespace e2lf::recon {

/// The largest share of the pixels of a still scene that start again with a cycle because its noise looks like a
/// change, with the sensors `paper` and `evk4-lcos`.
inline constexpr double kFalseAlarmRate = 0.05;

/// The largest number of cycles in a mean.
inline constexpr size_t kMostFusedCycles = 64;

/// The number of cycles after a change for which the newest cycle alone is shown.
inline constexpr uint8_t kUnsettledCycles = 4;

/// Fuses the cycles of a scene of which parts move: each pixel holds the mean of the cycles since the scene last
/// changed there.
///
/// A change is found by the residuals of the counts of the new cycle from the means, summed over blocks of 2x2 px,
/// which show fine texture that moved, and over cells of 4x4 px, which show weak texture. In windows of 12x12 and 20x20
/// px, the sums of their squares over all transitions are compared with those that the noise of the sensor makes
/// (CountNoise). Where one of them is larger, by more than chance allows, the cells around the middle of the window
/// start again with the new cycle. Near what changed with the last cycle, a smaller difference suffices.
///
/// What moves slowly may change by too little from one cycle to the next to be told from noise. A cell that started
/// again therefore shows the newest cycle alone until kUnsettledCycles more have passed without another change.
class CycleFusion {
 public:
  /// Prepares the fusion of event images, [transition, y, x], of lit transitions or of a whole cycle, from a camera
  /// with this profile. Means are over up to `most_cycles`, 1 to kMostFusedCycles; then each new cycle has the weight 1
  /// / most_cycles.
  CycleFusion(const capture::SensorProfile& camera, size_t most_cycles);

  /// Adds the event images of the next cycle. Another size than before starts everything again.
  void add(const PlanesView<const int16_t>& cycle);

  /// Returns the means, or the newest cycle where they are not settled, in 16 bits at which they saturate, and the
  /// effective number of cycles: the variance of the noise of one cycle divided by that of the mean. Exponential means
  /// reach 2 most_cycles - 1.
  [[nodiscard]] const capture::FusedCycles& fused() const { return fused_; }
  [[nodiscard]] size_t most_cycles() const { return most_cycles_; }
  /// Returns the share of the pixels that started again with the last cycle; 1 for the first one.
  [[nodiscard]] double changed() const { return changed_; }

 private:
  /// What is compared in a window around each cell, [cell_y, cell_x], in squared capture::kFusedUnits. Each value is
  /// the sum over the columns of the window.
  struct WindowEvidence {
    std::vector<float> blocks, cells;  ///< squares of the residuals of the blocks and of the cells
    std::vector<float> expected;       ///< what noise makes of either
    /// What the ratios of the first two to the last one exceed where the scene changed; the second pair applies near a
    /// change with the last cycle.
    std::array<std::array<float, 2>, 2> limits;
  };

  void restart(const PlanesView<const int16_t>& cycle);
  void compare_row(const PlanesView<const int16_t>& cycle, size_t cell_y);
  [[nodiscard]] std::vector<float> expected_noise(size_t cell_y);
  [[nodiscard]] float noise_of_cell(size_t cell_y, size_t cell_x);
  void find_changes(size_t cell_y);
  void update_row(const PlanesView<const int16_t>& cycle, size_t cell_y);
  template <class Body>
  void for_runs_alone(size_t cell_y, const Body& body) const;
  void restore_means(size_t cell_y);

  size_t most_cycles_;
  CountNoise noise_;
  // By the number of cycles added.
  std::vector<float> effective_;          ///< number of cycles
  std::vector<float> noise_of_residual_;  ///< variance of the residual, divided by that of one cycle
  std::vector<int16_t> weights_;          ///< mean_weight() of the newest cycle
  capture::FusedCycles fused_;
  capture::EventImages hidden_means_;  ///< means where fused_ shows the newest cycle alone; undefined elsewhere
  size_t cycle_ = 0;                   ///< number of cycles since everything started
  size_t cells_y_ = 0, cells_x_ = 0;
  // Of each cell, [cell_y, cell_x].
  std::vector<uint16_t> added_;     ///< number of cycles since the last change, up to a limit
  std::vector<uint8_t> unsettled_;  ///< number of cycles for which the newest one is still shown alone
  /// Variance of the sum of its counts in one cycle, summed over the transitions.
  std::vector<float> noise_of_cycle_;
  std::array<WindowEvidence, 2> evidence_;
  /// Whether it is found to change, starts again with this cycle, and lies near one that did with the last cycle.
  std::vector<uint8_t> is_found_, is_changed_, is_near_change_;
  double changed_ = 0;
};

}  // namespace e2lf::recon
