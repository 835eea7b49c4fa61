// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "e2lf/base/result.h"
#include "e2lf/capture/profile/sensor_constants.h"

namespace e2lf::recon {

/// Returns intensities as a function of the number h of half thresholds above black: eps (exp(tau h / 2) - 1). Counts
/// are whole numbers, so a table of the common values replaces the exponential.
class IntensityTable {
 public:
  /// Checks that eps and tau are positive and finite.
  [[nodiscard]] static Result<void> check(const capture::SensorConstants& constants) {
    if (std::isfinite(constants.eps) && constants.eps > 0 && std::isfinite(constants.tau) && constants.tau > 0) {
      return {};
    }
    return Error{ErrorCode::kInvalidValue, "eps and tau of the sensor must be positive; give its constants", ""};
  }

  explicit IntensityTable(const capture::SensorConstants& constants) : constants_(constants) {
    for (int h = -kRange; h <= kRange; ++h) table_[static_cast<size_t>(h + kRange)] = compute(h);
  }

  /// Returns the intensity at h half thresholds. The exponent is limited to 80, so that damaged counts give finite
  /// values.
  [[nodiscard]] float at_half_steps(int h) const {
    return h >= -kRange && h <= kRange ? table_[static_cast<size_t>(h + kRange)] : compute(h);
  }

  /// Returns the intensity at any number of thresholds.
  [[nodiscard]] float at_steps(float steps) const { return compute(2.0 * double{steps}); }

 private:
  static constexpr int kRange = 127;

  [[nodiscard]] float compute(double h) const {
    const double level = std::min(0.5 * h * double{constants_.tau}, 80.0);
    return static_cast<float>(std::min(double{constants_.eps} * std::expm1(level), 1e30));
  }

  capture::SensorConstants constants_;
  std::array<float, 2 * kRange + 1> table_;
};

}  // namespace e2lf::recon
