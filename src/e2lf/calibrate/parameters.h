// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/profile/camera.h"

namespace e2lf::calibrate {

inline constexpr double kQuantile = 1.96;  ///< of a normal distribution, for 95 %

/// A number of a camera that a fit may change.
struct Parameter {
  enum class Kind : uint8_t { kConstant, kTransmission, kSlopeX, kSlopeY };

  Kind kind = Kind::kConstant;
  size_t index = 0;          ///< of the constant, or of the lit pattern
  bool is_logarithm = true;  ///< fitted as a logarithm: the number stays positive, its spread is relative
  double spread = 0.0;       ///< how far it may plausibly lie from the first guess (one standard deviation)
  std::string key;           ///< as in camera files: "threshold_on", "transmission[1]", "transmission.slope_x[1]"

  [[nodiscard]] double get(const capture::Camera& camera) const;
  void set(capture::Camera& camera, double value) const;
};

/// What a fit of so many lit patterns changes: all constants of the pixels but eps (the unit of brightness) and the
/// times, and the transmission of each lit pattern relative to the first with its slopes. Those whose key is in `held`
/// are left out. Spreads are those that `start` states as its uncertainty, and plausible ones where it states none.
/// Fails with kInvalidValue when `held` has an unknown key, naming the nearest.
[[nodiscard]] Result<std::vector<Parameter>> fit_parameters(size_t num_lit, const capture::Camera& start,
                                                            const std::vector<std::string>& held);

/// The values of parameters in the form in which they are fitted, and back.
[[nodiscard]] Eigen::VectorXd to_vector(const std::vector<Parameter>& parameters, const capture::Camera& camera);
void from_vector(const std::vector<Parameter>& parameters, const Eigen::VectorXd& values, capture::Camera& camera);

}  // namespace e2lf::calibrate
