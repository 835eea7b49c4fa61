// SPDX-License-Identifier: MIT
// Renders views of layered scenes for scenes.py, which compiles this file. Positions are in px from the centre of the
// image.
#include <algorithm>
#include <cstring>

namespace {

using Taps = float __attribute__((vector_size(32)));  // four neighbours of two interleaved maps
constexpr int kSteps = 1024;                          // number of distinct positions between two pixels
constexpr int kBorder = 3;                            // by which maps are extended on every side, px
constexpr float kHidden = 1e-3F;                      // share of light from behind that no longer counts

/// The weights of Keys' cubic with a = -0.75, as in torch, each twice, for every distinct position.
struct WeightTable {
  Taps at[kSteps];

  WeightTable() {
    constexpr float a = -0.75F;
    const auto near = [](float x) { return ((a + 2) * x - (a + 3)) * x * x + 1; };
    const auto far = [](float x) { return ((a * x - 5 * a) * x + 8 * a) * x - 4 * a; };
    for (int step = 0; step < kSteps; ++step) {
      const float t = static_cast<float>(step) / kSteps;
      const float weights[] = {far(t + 1), near(t), near(1 - t), far(2 - t)};
      for (int i = 0; i < 8; ++i) at[step][i] = weights[i / 2];
    }
  }
};
const WeightTable kWeights;

Taps load(const float* p) {
  Taps taps;
  std::memcpy(&taps, p, sizeof(taps));
  return taps;
}

}  // namespace

extern "C" {

/// A surface with the disparity centre + slope . (y, x) + relief(y, x) in the central view, px per view step.
struct Layer {
  float centre, slope_y, slope_x;
  const float* maps;    ///< brightness and coverage, [side + 6, side + 6, 2]
  const float* relief;  ///< [side, side], or null
};

}  // extern "C"

namespace {

struct Seen {
  float disparity, brightness, coverage;
};

struct Camera {
  int side;
  float view_y, view_x;  ///< of the viewpoint, in view steps from the centre of the aperture

  [[nodiscard]] float relief_at(const float* relief, float y, float x) const {
    const float middle = 0.5F * static_cast<float>(side - 1), last = static_cast<float>(side) - 1.001F;
    y = std::clamp(y + middle, 0.0F, last), x = std::clamp(x + middle, 0.0F, last);
    const int row = static_cast<int>(y), column = static_cast<int>(x);
    const float below = y - static_cast<float>(row), right = x - static_cast<float>(column);
    const float* p = relief + row * side + column;
    return (1 - below) * ((1 - right) * p[0] + right * p[1]) + below * ((1 - right) * p[side] + right * p[side + 1]);
  }

  /// Returns what the ray through pixel (y, x) meets: the point q of the layer for which q + view * disparity(q) is the
  /// pixel.
  [[nodiscard]] Seen see(const Layer& layer, float y, float x) const {
    const float plane =
        (layer.centre + layer.slope_y * y + layer.slope_x * x) / (1 + layer.slope_y * view_y + layer.slope_x * view_x);
    float relief = 0;
    for (int i = 0; layer.relief && i < 3; ++i) {
      relief = relief_at(layer.relief, y - view_y * (plane + relief), x - view_x * (plane + relief));
    }
    const float disparity = plane + relief;
    const Seen maps = sample(layer.maps, y - view_y * disparity, x - view_x * disparity);
    return {disparity, maps.brightness, maps.coverage};
  }

  [[nodiscard]] Seen sample(const float* maps, float y, float x) const {
    const float middle = 0.5F * static_cast<float>(side - 1);
    const auto in_steps = [&](float at) {
      return static_cast<unsigned>((std::clamp(at + middle, -1.0F, static_cast<float>(side)) + 1) * kSteps + 0.5F);
    };
    const unsigned down = in_steps(y), across = in_steps(x), stride = 2 * (side + 2 * kBorder);
    const float* first = maps + (down / kSteps + kBorder - 2) * stride + 2 * (across / kSteps + kBorder - 2);
    const Taps& weights = kWeights.at[down % kSteps];
    Taps column = weights[0] * load(first) + weights[2] * load(first + stride) + weights[4] * load(first + 2 * stride) +
                  weights[6] * load(first + 3 * stride);
    column *= kWeights.at[across % kSteps];
    return {0, column[0] + column[2] + column[4] + column[6],
            std::clamp(column[1] + column[3] + column[5] + column[7], 0.0F, 1.0F)};
  }
};

}  // namespace

extern "C" {

/// Renders views [views, size, size] of layers that are ordered back to front, of which the first covers everything.
void render_views(const Layer* layers, int count, int side, int size, const float* views_y, const float* views_x,
                  int views, float* out) {
  const float corner = -0.5F * static_cast<float>(size - 1);
  for (int view = 0; view < views; ++view) {
    const Camera camera{side, views_y[view], views_x[view]};
    for (int pixel = 0; pixel < size * size; ++pixel) {
      const float y = static_cast<float>(pixel / size) + corner, x = static_cast<float>(pixel % size) + corner;
      float light = 0, through = 1;
      for (int i = count; i-- > 0 && through > kHidden;) {
        const Seen seen = camera.see(layers[i], y, x);
        const float coverage = i == 0 ? 1 : seen.coverage;
        light += through * coverage * seen.brightness;
        through *= 1 - coverage;
      }
      *out++ = std::clamp(light, 0.0F, 1.0F);
    }
  }
}

/// Writes the disparity [size, size] of the nearest layer that covers more than half of a pixel.
void render_disparity(const Layer* layers, int count, int side, int size, float view_y, float view_x, float* out) {
  const Camera camera{side, view_y, view_x};
  const float corner = -0.5F * static_cast<float>(size - 1);
  for (int pixel = 0; pixel < size * size; ++pixel) {
    const float y = static_cast<float>(pixel / size) + corner, x = static_cast<float>(pixel % size) + corner;
    int nearest = count;
    Seen seen{};
    do {
      seen = camera.see(layers[--nearest], y, x);
    } while (nearest > 0 && seen.coverage <= 0.5F);
    *out++ = seen.disparity;
  }
}

}  // extern "C"
