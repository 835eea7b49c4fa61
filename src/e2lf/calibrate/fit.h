// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/calibrate/flat_areas.h"
#include "e2lf/calibrate/parameters.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"

namespace e2lf::calibrate {

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
  int most_iterations = 30;
  double most_row_samples = kRowSamples;  ///< upper limit of the weight of a row of brightness
  double misfit = 1.0;                    ///< divisor of the deviance relative to the prior
  ProgressFn progress = {};
};

/// The bounds within which a fit keeps a constant.
struct Bound {
  capture::PixelConstant constant;
  float low, high;
};
[[nodiscard]] std::vector<Bound> fit_bounds();

/// The misfit of the best model, in units of what chance alone causes.
struct Misfit {
  double weighted = 1.0;     ///< value with the weights of the fit, at least 1
  double full = 1.0;         ///< value with all samples
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
