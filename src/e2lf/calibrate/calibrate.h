// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/calibrate/agreement.h"
#include "e2lf/calibrate/still_scene.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"

namespace e2lf::calibrate {

struct CalibrationOptions {
  std::vector<std::string> held;  ///< keys of constants that keep their starting value
  bool is_even = false;           ///< the scenes are known to be even within each cell of the field: see even_areas()
  bool keep_out = false;          ///< fits every second square of 64 px and compares on the others
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
  AgreementReport agreement;        ///< agreement of the result with the events
  AgreementReport first_agreement;  ///< agreement of the first guess
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

}  // namespace e2lf::calibrate
