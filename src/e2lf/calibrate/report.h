// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/calibrate/calibrate.h"
#include "e2lf/files/options.h"

namespace e2lf::calibrate {

/// Formats a calibration as text: constants with their ranges, bad pixels, and measured counts beside those of the
/// model, by brightness.
[[nodiscard]] std::string report_text(const Calibration& calibration);

/// Returns the calibration as JSON: {"constants": [..], "warnings": [..], "pixels": {..}, "rows": [..], "places": [..],
/// "first_guess": {..}}.
[[nodiscard]] Json report_json(const Calibration& calibration);

/// Returns the camera file of a calibration: to_json() of the camera, with the source of each constant.
[[nodiscard]] Json camera_json(const Calibration& calibration);

}  // namespace e2lf::calibrate
