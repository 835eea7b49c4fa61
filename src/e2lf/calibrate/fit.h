// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/calibrate/still_scene.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"

namespace e2lf::calibrate {

inline constexpr double kQuantile = 1.96;  ///< two-sided 95 % quantile of the standard normal distribution

/// A number of a camera that a fit may change.
struct Parameter {
  /// The list of transmissions or slopes that the number belongs to; null for a constant of the pixels.
  std::vector<float> capture::SensorProfile::*list = nullptr;
  size_t index = 0;          ///< index of the constant or of the active pattern
  bool is_logarithm = true;  ///< fitted as a logarithm: the number stays positive, and its spread is relative
  double spread = 0.0;       ///< prior standard deviation from the starting value
  std::string key;           ///< as in camera files: "threshold_on", "transmission[1]", "transmission.slope_x[1]"

  [[nodiscard]] bool is_transmission() const { return list == &capture::SensorProfile::transmission; }
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

/// The model that a fit compares with the histograms: the camera, and the brightness of each area as ln((full aperture)
/// / eps).
struct Model {
  capture::SensorProfile camera;
  std::vector<double> brightness;
};

/// The shares of the aperture that the patterns of a cycle open.
struct OpenShares {
  std::vector<float> of_codes;
  bool is_whole = false;  ///< the codes are followed by their inverses and by black: see capture::whole_cycle()
};

/// Returns the probabilities of counts in an area of this brightness.
[[nodiscard]] std::vector<double> predict(const capture::SensorProfile& camera, const OpenShares& open_shares,
                                          const Area& area, double brightness);

/// Returns the share of the aperture that each pattern opens.
[[nodiscard]] OpenShares open_shares(const capture::Codes& codes);

/// Returns the brightness of each area that fits a camera best.
[[nodiscard]] std::vector<double> fit_brightness(const capture::SensorProfile& camera, const OpenShares& open_shares,
                                                 const std::vector<Area>& areas);

inline constexpr double kRowSamples = 4000.0;

struct FitOptions {
  double most_row_samples = kRowSamples;  ///< upper limit of the weight of a row of brightness
  double misfit = 1.0;                    ///< divisor of the deviance relative to the prior
  ProgressFn progress = {};
};

/// The bounds within which a fit keeps a constant.
struct Bound {
  capture::PixelConstant constant;
  float low, high;
};
inline constexpr Bound kFitBounds[] = {
    {capture::PixelConstant::kMismatch, 0.0F, 0.5F}, {capture::PixelConstant::kMismatchEach, 0.0F, 0.5F},
    {capture::PixelConstant::kLeak, 0.0F, 0.4F},     {capture::PixelConstant::kDarkOff, 0.0F, 0.4F},
    {capture::PixelConstant::kDarkOn, 0.0F, 0.4F},   {capture::PixelConstant::kResetSpan, 0.0F, 2.0F}};

/// The misfit of the best model, in units of what chance alone causes.
struct Misfit {
  double weighted = 1.0;     ///< value with the weights of the fit, at least 1
  double row_samples = 0.0;  ///< number of samples of a row at which chance and model error weigh the same
};

struct Fit {
  Model model;
  Eigen::MatrixXd information;  ///< Fisher information of the data alone at the result, divided by misfit.weighted
  Misfit misfit;
};

/// Finds the most likely camera and brightness of each area, given how often each combination of counts occurs there.
/// It minimises the deviance, divided by FitOptions::misfit, plus the squared distance of each parameter from `start`
/// in units of its spread. A share of 0.0001 of the samples is attributed to other causes, so that no rare count
/// dominates. Likelihood is used because most combinations are rare: the distance of square roots (Hellinger) is biased
/// for these. The weight of a row of brightness is limited to most_row_samples. Beyond that, the misfit is due to the
/// model rather than to chance, and no row should hide the others.
///
/// The method is Fisher scoring with Levenberg damping and finite differences. The brightness of each area is
/// eliminated from the equations (variable projection), since it affects one area only. The result is deterministic and
/// does not depend on the number of threads.
[[nodiscard]] Fit fit_camera(const std::vector<Parameter>& parameters, const OpenShares& open_shares,
                             const std::vector<Area>& areas, const capture::SensorProfile& start, const Model& first,
                             const FitOptions& options);

/// Returns the change of the parameters that one step of fit_camera() from `model` would make without damping.
[[nodiscard]] Eigen::VectorXd next_move(const std::vector<Parameter>& parameters, const OpenShares& open_shares,
                                        const std::vector<Area>& areas, const capture::SensorProfile& start,
                                        const Model& model, const FitOptions& options);

}  // namespace e2lf::calibrate
