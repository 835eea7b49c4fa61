// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/calibrate/flat_areas.h"
#include "e2lf/calibrate/parameters.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/camera.h"

namespace e2lf::calibrate {

/// What a fit compares with the histograms: the camera, and each area's brightness as ln((full aperture) / eps).
struct Model {
  capture::Camera camera;
  std::vector<double> brightness;
};

/// The probabilities of counts in an area of that brightness.
[[nodiscard]] std::vector<double> predict(const capture::Camera& camera, const std::vector<float>& open_shares,
                                          const Area& area, double brightness);

/// The share of the aperture that each pattern opens.
[[nodiscard]] std::vector<float> open_shares(const capture::Codes& codes);

/// The brightness of each area that fits a camera best.
[[nodiscard]] std::vector<double> fit_brightness(const capture::Camera& camera, const std::vector<float>& open_shares,
                                                 const std::vector<Area>& areas);

inline constexpr double kRowSamples = 4000.0;

struct FitOptions {
  int most_iterations = 30;
  double most_row_samples = kRowSamples;  ///< as which a row of brightness counts at most
  double misfit = 1.0;                    ///< by which the deviance is divided, beside what is known before
  ProgressFn progress = {};
};

/// Between which a fit keeps a constant.
struct Bound {
  capture::PixelConstant constant;
  float low, high;
};
[[nodiscard]] std::vector<Bound> fit_bounds();

/// How far the best model is off, in units of what chance alone makes.
struct Misfit {
  double weighted = 1.0;     ///< with the weights of the fit, at least 1
  double full = 1.0;         ///< with all samples
  double row_samples = 0.0;  ///< of a row for which chance and the model's own error weigh the same
};

struct Fit {
  Model model;
  Eigen::MatrixXd information;  ///< of the data alone: Fisher's at the result, divided by misfit.weighted
  Misfit misfit;
};

/// The most likely camera and brightness of each area, given how often each combination of counts occurs there. What is
/// least is the deviance, divided by FitOptions::misfit, plus the squared distance of each parameter from `start` in
/// units of its spread. A share of 0.0001 of the samples is taken for something else, so that no rare count decides.
/// Likelihood, since most combinations are rare: the distance of roots (Hellinger) is biased for these. A row of
/// brightness counts as most_row_samples at most: beyond that it is the model that is off, not chance, and no row shall
/// hide the others.
///
/// Fisher scoring with Levenberg's damping, with differences for derivatives. The brightness of each area is taken out
/// of the equations (variable projection), since it touches one area alone. Deterministic; the same for any number of
/// threads.
[[nodiscard]] Fit fit_camera(const std::vector<Parameter>& parameters, const std::vector<float>& open_shares,
                             const std::vector<Area>& areas, const capture::Camera& start, const Model& first,
                             const FitOptions& options);

/// The change of the parameters by which one step of fit_camera() would leave `model`, without damping.
[[nodiscard]] Eigen::VectorXd next_move(const std::vector<Parameter>& parameters, const std::vector<float>& open_shares,
                                        const std::vector<Area>& areas, const capture::Camera& start,
                                        const Model& model, const FitOptions& options);

}  // namespace e2lf::calibrate
