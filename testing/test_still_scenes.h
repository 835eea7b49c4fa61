// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>

#include "e2lf/calibrate/still_scene.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/sensor/pixel_model.h"

namespace e2lf::calibrate {

/// Returns a camera similar to that of cameras/evk4-lcos.json, in which all constants have an effect.
inline capture::SensorProfile plain_camera() {
  using enum capture::PixelConstant;
  capture::SensorProfile camera;
  camera.name = "plain";
  camera.event_model = "pixel";
  camera.pixel.values = {0.01F, 27.0F, 280.0F, 0.0015F, 0.40F, 0.35F, 0.10F,   0.03F,
                         0.07F, 0.1F,  1.0F,   0.04F,   0.03F, 0.02F, 0.0156F, 0.0104F};
  camera.transmission = {1.0F, 1.03F, 1.1F};
  return camera;
}

/// Returns 5x3 even patches of 128x160 px, whose brightness increases by equal factors in mixed order, so that each
/// part of the field has dark and bright ones. All views are equal.
inline lightfield::LightField patches(float darkest, float brightest) {
  constexpr size_t kRows = 3, kColumns = 5, kHeight = 160, kWidth = 128, kPatches = kRows * kColumns;
  lightfield::LightField field({8, 8, kRows * kHeight, kColumns * kWidth});
  const size_t size = kRows * kHeight * kColumns * kWidth;
  for (size_t p = 0; p < size; ++p) {
    const size_t row = p / (kColumns * kWidth) / kHeight, column = p % (kColumns * kWidth) / kWidth;
    const size_t place = (row * kColumns + column) * 7 % kPatches;  // 7 and 15 have no common factor
    const float share = static_cast<float>(place) / (kPatches - 1);
    const float value = darkest * std::pow(brightest / darkest, share);
    for (size_t view = 0; view < 64; ++view) field.data()[view * size + p] = value;
  }
  return field;
}

/// Returns black, followed by patterns that open an eighth, three quarters and a quarter of every cell.
inline capture::Codes known_open_areas() {
  capture::Codes codes(4, 8, 8);
  size_t n = 0;
  for (const float share : {0.0F, 0.125F, 0.75F, 0.25F}) {
    std::fill(codes.pattern(n).begin(), codes.pattern(n).end(), share);
    ++n;
  }
  return codes;
}

/// Simulates the cycles of a scene as a camera records them.
inline StillScene simulate(const capture::SensorProfile& camera, const lightfield::LightField& field, size_t cycles,
                           const capture::Codes& codes = capture::default_codes()) {
  StillScene scene;
  for (size_t cycle = 0; cycle < cycles; ++cycle) {
    scene.cycles.push_back(
        sensor::simulate_pixel_events(codes, field, camera, {.seed = 1 + cycle, .map_seed = 1}).value());
  }
  return scene;
}

}  // namespace e2lf::calibrate
