// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "e2lf/base/result.h"
#include "e2lf/capture/profile/sensor_constants.h"

namespace e2lf::recon {

/// The intensity that lies a number of half thresholds above black: eps (exp(tau h / 2) - 1), h = 0 at black. Counts
/// are whole numbers, so a table of the common ones replaces the exponential.
class IntensityTable {
 public:
  /// Success when eps and tau are positive and finite.
  [[nodiscard]] static Result<void> check(const capture::SensorConstants& constants) {
    if (std::isfinite(constants.eps) && constants.eps > 0 && std::isfinite(constants.tau) && constants.tau > 0) {
      return {};
    }
    return Error{ErrorCode::kInvalidValue, "eps and tau of the sensor must be positive; give its constants", ""};
  }

  explicit IntensityTable(const capture::SensorConstants& constants) : constants_(constants) {
    for (int h = -kRange; h <= kRange; ++h) table_[static_cast<size_t>(h + kRange)] = compute(h);
  }

  /// Limited at exp(80), so that damaged counts stay finite.
  [[nodiscard]] float at_half_steps(int h) const {
    return h >= -kRange && h <= kRange ? table_[static_cast<size_t>(h + kRange)] : compute(h);
  }

  /// The same for any number of thresholds.
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
