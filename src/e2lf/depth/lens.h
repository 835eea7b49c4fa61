// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "e2lf/base/result.h"

namespace e2lf::depth {

/// A calibrated lens with a coded aperture. The middle view is a pinhole camera with the constants of OpenCV's
/// calibrateCamera(); the others are displaced by the baseline and show the same rectangle at the focus distance.
struct Lens {
  size_t width = 0, height = 0;           ///< size of the calibrated views, px
  std::array<double, 2> focal_px = {};    ///< focal lengths along x and y
  std::array<double, 2> centre_px = {};   ///< principal point (x, y); the middle of the first pixel is (0, 0)
  std::array<double, 5> distortion = {};  ///< k1, k2, p1, p2, k3
  double baseline_m = 0;                  ///< distance of neighbouring views
  double focus_m = 0;                     ///< distance at which the disparity is 0

  /// Returns the disparity at infinite distance, px per view step: focal_px[0] * baseline_m / focus_m.
  [[nodiscard]] double infinity_px() const { return focal_px[0] * baseline_m / focus_m; }

  /// Returns the depth of a disparity, in metres; infinite or negative for disparities of at least infinity_px().
  [[nodiscard]] double depth_m(double disparity_px) const { return focus_m / (1 - disparity_px / infinity_px()); }

  /// Returns (x, y) at depth 1 of the ray through a pixel of the middle view, without the distortion.
  [[nodiscard]] std::array<double, 2> ray(double x_px, double y_px) const;
};

/// Reads {"width", "height", "focal_px": [x, y], "centre_px": [x, y], "distortion": [k1, k2, p1, p2, k3], "baseline_m",
/// "focus_m"}, as examples/lens/calibrate_lens.py writes it. Fails with kInvalidValue if a length is not positive.
[[nodiscard]] Result<Lens> read_lens(const std::filesystem::path& path);

}  // namespace e2lf::depth
