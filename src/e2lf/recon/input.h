// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/base/strided_view.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/model/model.h"

namespace e2lf::recon {

/// Returns intensities as a function of the level above black, in thresholds: eps (exp(tau level) - 1). In one cycle,
/// levels are whole numbers of half thresholds, so a table of the common values replaces the exponential.
class IntensityTable {
 public:
  /// Checks that eps and tau are positive and finite.
  [[nodiscard]] static Result<void> check(const capture::SensorConstants& constants) {
    if (std::isfinite(constants.eps) && constants.eps > 0 && std::isfinite(constants.tau) && constants.tau > 0) {
      return {};
    }
    return fail(ErrorCode::kInvalidValue, "", "eps and tau of the sensor must be positive; give its constants");
  }

  explicit IntensityTable(const capture::SensorConstants& constants) : constants_(constants) {
    for (int h = -kRange; h <= kRange; ++h) table_[static_cast<size_t>(h + kRange)] = at(0.5 * h);
  }

  /// Returns the intensity at h half thresholds.
  [[nodiscard]] float at_half_steps(int h) const {
    return h >= -kRange && h <= kRange ? table_[static_cast<size_t>(h + kRange)] : at(0.5 * h);
  }

  /// Returns the intensity at any level. The exponent is limited to 80, so that damaged counts give finite values.
  [[nodiscard]] float at(double level) const {
    const double exponent = std::min(level * double{constants_.tau}, 80.0);
    return static_cast<float>(std::min(double{constants_.eps} * std::expm1(exponent), 1e30));
  }

 private:
  static constexpr int kRange = 127;

  capture::SensorConstants constants_;
  std::array<float, 2 * kRange + 1> table_;
};

/// The input of a network: float32 [channel, y, x], row-major.
using InputPlanes = Planes<float>;

/// The position of the upper left pixel of an image on the grid of a network.
struct GridShift {
  size_t y = 0, x = 0;
  bool operator==(const GridShift&) const = default;
};

/// The conditions under which the counts of event images were recorded.
struct InputConditions {
  capture::SensorConstants constants = {};  ///< eps and tau are used for intensities
  std::vector<float> conditioning = {};     ///< the conditioning vector capture::conditioning_vector()
  size_t cycles = 1;     ///< number of cycles of a static scene over which counts are summed, unless they are fused
  GridShift shift = {};  ///< the images are extended by this at the top and on the left
  size_t cycles_condition = capture::kCyclesCondition;  ///< the element of `conditioning` for the number of cycles
};

/// Makes the input channels of `groups` in `planes`, whose memory is reused, one group after another (see
/// model::InputKind; C_k, m and J_k as in invert_events() with `centred`). The channels of a camera hold its
/// conditioning vector, and counts are divided by the number of cycles. Of fused cycles, the fused counts are taken,
/// and the element for the number of cycles is that of each pixel. Height and width, with the shift, are rounded up to
/// multiples of `size_multiple`. The additional rows and columns on every side are mirror images: the absence of events
/// would look like a black frame to a network, and repeated pixels like stripes. The image behind a lens array could
/// only be extended by whole lenses and therefore allows no shift. Fails with kInvalidValue if a group needs constants
/// that are not positive. If `measurement` lacks the data for a group, the contract is broken.
[[nodiscard]] Result<void> network_input(const capture::MeasurementView& measurement,
                                         std::span<const model::InputGroup> groups, const InputConditions& conditions,
                                         size_t size_multiple, InputPlanes& planes);

}  // namespace e2lf::recon
