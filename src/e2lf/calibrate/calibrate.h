// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/calibrate/fit.h"
#include "e2lf/calibrate/still_scene.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/files/options.h"

namespace e2lf::calibrate {

/// The means, standard deviations and correlations of the counts of one cycle.
struct Moments {
  std::vector<double> mean, deviation;  ///< one value for each transition
  std::vector<double> correlation;  ///< between transitions 1 and 2, 2 and 3, 1 and 3, then of the pairs 4 and 5, ...
};

/// How well a model predicts the counts of a set of areas.
struct Agreement {
  double brightness = 0.0;  ///< mean count of the first two transitions
  double samples = 0.0;
  Moments measured, simulated;
  double total_variation = 0.0;  ///< mean distance of the joint histograms: 0 = equal, 1 = disjoint
  double chance = 0.0;           ///< approximately its value if the model is true, due to the number of samples
};

/// Computes the agreement of a camera with areas, each of which gets the brightness that fits it best. Rows of fewer
/// than 300 samples are omitted.
[[nodiscard]] std::vector<Agreement> compare(const capture::SensorProfile& camera, const OpenShares& open_shares,
                                             const std::vector<Area>& areas);

struct CalibrationOptions {
  std::vector<std::string> held;  ///< keys of constants that keep their starting value
  bool is_even = false;           ///< the scenes are known to be even within each cell of the field: see even_areas()
  ProgressFn progress = {};
};

/// One constant after a calibration.
struct Estimate {
  std::string key;
  double value = 0.0;
  double low = 0.0, high = 0.0;  ///< 95 % interval; if not determined, the range of the starting camera
  bool is_determined = false;    ///< fitted, rather than kept from the starting camera: see calibrate()
};

struct Calibration {
  capture::SensorProfile camera;
  std::vector<Estimate> estimates;
  std::vector<PixelState> states;
  std::vector<Agreement> agreement;  ///< of the result with the events, one for each level of brightness
  size_t flat_pixels = 0;
  std::vector<std::string> warnings;  ///< constants at a bound or outside of the starting camera's uncertainty, by name
};

/// Estimates the constants of a camera of the event model "pixel" from static scenes that were coded by known patterns.
/// Constants that the data do not determine keep their values in `start`. A constant is determined if its standard
/// deviation is at most half of the uncertainty stated in `start`, or of a plausible spread if none is stated. If
/// several constants are correlated, the least determined one is held, until the rest is determined. This holds for
/// even areas. In areas that were found by search, the receptor's rate keeps its value, and all others take their most
/// likely values, which stay near those of `start` unless the data contradict them. The standard deviation is the
/// larger of two: the one from the curvature, widened by the misfit, and the jackknife over eight parts of the picture.
/// Codes of capture::whole_cycle() use the events of all transitions.
///
/// Fails with kShape (scenes that do not match each other or the patterns, see check_scenes), and kInvalidValue
/// (`start` has another event model, patterns do not begin with black, unknown keys, or too few flat areas).
[[nodiscard]] Result<Calibration> calibrate(const std::vector<StillScene>& scenes, const capture::Codes& codes,
                                            const capture::SensorProfile& start, const CalibrationOptions& options);

/// Formats a calibration as text: constants with their ranges, bad pixels, and measured counts beside those of the
/// model, by brightness.
[[nodiscard]] std::string report_text(const Calibration& calibration);

/// Returns the calibration as JSON: {"constants": [..], "warnings": [..], "pixels": {..}, "rows": [..]}.
[[nodiscard]] Json report_json(const Calibration& calibration);

/// Returns the camera file of a calibration: to_json() of the camera, with the source of each constant.
[[nodiscard]] Json camera_json(const Calibration& calibration);

}  // namespace e2lf::calibrate
