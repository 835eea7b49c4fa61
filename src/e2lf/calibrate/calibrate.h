// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/calibrate/agreement.h"
#include "e2lf/calibrate/still_scene.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/camera.h"

namespace e2lf::calibrate {

struct CalibrationOptions {
  std::vector<std::string> held;  ///< keys of constants that stay at the first guess
  bool is_even = false;           ///< scenes are known to be even within each cell of the field: see even_areas()
  bool keep_out = false;          ///< fit every second square of 64 px, and compare on the others
  ProgressFn progress = {};
};

/// One constant after a calibration.
struct Estimate {
  std::string key;
  double value = 0.0;
  double low = 0.0, high = 0.0;  ///< 95 % of chance; of one that is not determined, the first guess's own range
  bool is_determined = false;    ///< the data say at least twice as much as the first guess did
};

struct Calibration {
  capture::Camera camera;
  std::vector<Estimate> estimates;
  std::vector<PixelState> states;
  AgreementReport agreement;        ///< of the result
  AgreementReport first_agreement;  ///< of the first guess
  size_t flat_pixels = 0;
  std::vector<std::string> warnings;  ///< constants at a bound, or out of the first guess's uncertainty, by name
};

/// Finds the constants of a camera of the model "pixel" from scenes that stood still, coded by known
/// patterns. `start` is the first guess: what the data do not determine stays there. A constant is determined where its
/// standard deviation is at most half of what the first guess states as its uncertainty, or of a plausible spread where
/// it states none. Where several trade against each other in even areas, the least determined one is held, until the
/// rest is. In areas that were searched for none of them counts as determined. Deviations are the larger of two: that
/// of the curvature, widened by the misfit, and that over eight parts of the picture left out in turn.
///
/// Fails with kShape (scenes that do not fit each other or the patterns, see check_scenes), and kInvalidValue (a
/// start of another event model, patterns that do not begin with black, unknown keys, too few flat areas).
[[nodiscard]] Result<Calibration> calibrate(const std::vector<StillScene>& scenes, const capture::Codes& codes,
                                            const capture::Camera& start, const CalibrationOptions& options);

/// The factor on both thresholds of each flat pixel, from its own counts: the mean of what is likely given them, with
/// the camera's mismatch as what is known before. NaN where the scene is not flat. More cycles tell more: of one the
/// factor hardly leaves 1.
[[nodiscard]] Plane threshold_map(const std::vector<StillScene>& scenes, const capture::Codes& codes,
                                  const capture::Camera& camera, const std::vector<PixelState>& states,
                                  bool is_even = false);

}  // namespace e2lf::calibrate
