// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/coded_intensities.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/cycles/shown_pattern.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::streams {

using cycles::ShownPattern;

/// Computes the light that reaches each pixel through the pattern on the aperture: through the open cells, with the
/// transmission that the camera states for each place, and the leak through the closed ones; and through an inverse,
/// the light of the open aperture minus that of the pattern, as in sensor::simulate_pixel_events().
class ShownLight {
 public:
  ShownLight(const capture::Codes& codes, const capture::SensorProfile& camera, float gain, size_t height,
             size_t width);

  /// Computes the coded intensities of a scene, followed by those of the open aperture. Fails with kShape as
  /// sensor::coded_intensities() does.
  [[nodiscard]] Result<capture::CodedIntensities> measure(const lightfield::LightField& scene) const;

  /// Computes the image [y, x] through one pattern. `intensities` must come from measure().
  void image(const capture::CodedIntensities& intensities, ShownPattern shown, std::vector<float>& light) const;

  /// Returns true if all cells are closed.
  [[nodiscard]] bool is_black(ShownPattern shown) const;

 private:
  capture::Codes codes_;                          ///< followed by an open pattern
  std::vector<std::vector<float>> transmission_;  ///< one map [y, x] for each of a2, a3, ...
  float gain_, leak_;
};

}  // namespace e2lf::streams
