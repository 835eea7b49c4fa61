// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/coded_intensities.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/camera.h"
#include "e2lf/cycles/shown_pattern.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::streams {

using cycles::ShownPattern;

/// The light that reaches each pixel through what the aperture shows: open cells with the transmission that the camera
/// states at each place, and what leaks through the closed ones; through an inverse the light of the open aperture
/// less that of the pattern. As sensor::simulate_pixel_events() has it.
class ShownLight {
 public:
  ShownLight(const capture::Codes& codes, const capture::Camera& camera, float gain, size_t height, size_t width);

  /// The coded intensities of a scene, and behind them those of the open aperture. Fails with kShape as
  /// sensor::coded_intensities() does.
  [[nodiscard]] Result<capture::CodedIntensities> measure(const lightfield::LightField& scene) const;

  /// The image [y, x] of one pattern; intensities are as measure() gives them.
  void image(const capture::CodedIntensities& intensities, ShownPattern shown, std::vector<float>& light) const;

  /// All cells are closed.
  [[nodiscard]] bool is_black(ShownPattern shown) const;

 private:
  capture::Codes codes_;                          ///< and one more that is open
  std::vector<std::vector<float>> transmission_;  ///< of a2, a3, ... [y, x]
  float gain_, leak_;
};

}  // namespace e2lf::streams
