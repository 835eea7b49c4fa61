// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/profile/sensor_profile.h"

namespace e2lf::calibrate {

inline constexpr double kQuantile = 1.96;  ///< two-sided 95 % quantile of the standard normal distribution

/// A number of a camera that a fit may change.
struct Parameter {
  enum class Kind : uint8_t { kConstant, kTransmission, kSlopeX, kSlopeY };

  Kind kind = Kind::kConstant;
  size_t index = 0;          ///< index of the constant or of the active pattern
  bool is_logarithm = true;  ///< fitted as a logarithm: the number stays positive, and its spread is relative
  double spread = 0.0;       ///< prior standard deviation from the starting value
  std::string key;           ///< as in camera files: "threshold_on", "transmission[1]", "transmission.slope_x[1]"

  [[nodiscard]] double get(const capture::SensorProfile& camera) const;
  void set(capture::SensorProfile& camera, double value) const;
};

/// Returns the parameters of a fit with `num_lit` active patterns: all constants of the pixels except eps (the unit of
/// brightness) and the times, and the transmission of each active pattern relative to the first one, with its slopes.
/// Parameters whose key is in `held` are omitted. Spreads are the uncertainties stated in `start`, or plausible ones if
/// none are stated. Fails with kInvalidValue if `held` has an unknown key; the message suggests the nearest one.
[[nodiscard]] Result<std::vector<Parameter>> fit_parameters(size_t num_lit, const capture::SensorProfile& start,
                                                            const std::vector<std::string>& held);

/// Convert between a camera and the vector of its parameters in the form in which they are fitted.
[[nodiscard]] Eigen::VectorXd to_vector(const std::vector<Parameter>& parameters, const capture::SensorProfile& camera);
void from_vector(const std::vector<Parameter>& parameters, const Eigen::VectorXd& values,
                 capture::SensorProfile& camera);

}  // namespace e2lf::calibrate
