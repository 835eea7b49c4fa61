// SPDX-License-Identifier: MIT
// Renders views of layered scenes for scenes.py, which compiles this file for the CPU or, with nvcc, for a GPU.
// Positions are in px from the centre of the image.
#ifdef __CUDACC__
#define ON_DEVICE __device__
#else
#define ON_DEVICE
#endif

namespace {

constexpr int kBorder = 3;        // by which maps are extended on every side, px
constexpr float kHidden = 1e-3F;  // share of light from behind that no longer counts

ON_DEVICE float clamped(float x, float low, float high) {
  return x < low ? low : x > high ? high : x;
}

/// The weights of Keys' cubic with a = -0.75, as in torch, of four neighbours, for a position t behind the second one.
ON_DEVICE void cubic_weights(float t, float* weights) {
  constexpr float a = -0.75F;
  const float s = 1 - t;
  weights[0] = a * t * s * s;
  weights[1] = ((a + 2) * t - (a + 3)) * t * t + 1;
  weights[2] = ((a + 2) * s - (a + 3)) * s * s + 1;
  weights[3] = a * s * t * t;
}

/// A surface with the disparity centre + slope . (y, x) + relief(y, x) in the central view, px per view step.
struct Layer {
  float centre, slope_y, slope_x;
  const float* maps;    ///< brightness and coverage, [side + 6, side + 6, 2]
  const float* relief;  ///< [side, side]
};

/// Layers of scenes, each from back to front, of which the first covers everything: of scene s those in
/// [first[s], first[s + 1]).
struct Scenes {
  const float* planes;   ///< [layers, 3]: centre, slope_y, slope_x
  const float* maps;     ///< [layers, side + 6, side + 6, 2]
  const float* reliefs;  ///< [layers, side, side]
  const int* first;
  int side, size;

  ON_DEVICE Layer layer(int i) const {
    const long long pixels = static_cast<long long>(side) * side, extended = side + 2 * kBorder;
    return {planes[3 * i], planes[3 * i + 1], planes[3 * i + 2], maps + 2 * extended * extended * i,
            reliefs + pixels * i};
  }
};

struct Seen {
  float disparity, brightness, coverage;
};

struct Camera {
  int side;
  float view_y, view_x;  ///< of the viewpoint, in view steps from the centre of the aperture

  ON_DEVICE float relief_at(const float* relief, float y, float x) const {
    const float middle = 0.5F * static_cast<float>(side - 1), last = static_cast<float>(side) - 1.001F;
    y = clamped(y + middle, 0, last), x = clamped(x + middle, 0, last);
    const int row = static_cast<int>(y), column = static_cast<int>(x);
    const float below = y - static_cast<float>(row), right = x - static_cast<float>(column);
    const float* p = relief + row * side + column;
    return (1 - below) * ((1 - right) * p[0] + right * p[1]) + below * ((1 - right) * p[side] + right * p[side + 1]);
  }

  /// Returns what the ray through pixel (y, x) meets: the point q of the layer for which q + view * disparity(q) is the
  /// pixel.
  ON_DEVICE Seen see(const Layer& layer, float y, float x) const {
    const float plane =
        (layer.centre + layer.slope_y * y + layer.slope_x * x) / (1 + layer.slope_y * view_y + layer.slope_x * view_x);
    float relief = 0;
    for (int i = 0; i < 3; ++i)
      relief = relief_at(layer.relief, y - view_y * (plane + relief), x - view_x * (plane + relief));
    const float disparity = plane + relief;
    const Seen maps = sample(layer.maps, y - view_y * disparity, x - view_x * disparity);
    return {disparity, maps.brightness, maps.coverage};
  }

  ON_DEVICE Seen sample(const float* maps, float y, float x) const {
    const float middle = 0.5F * static_cast<float>(side - 1), last = static_cast<float>(side);
    y = clamped(y + middle, -1, last) + kBorder, x = clamped(x + middle, -1, last) + kBorder;
    const int row = static_cast<int>(y), column = static_cast<int>(x), stride = 2 * (side + 2 * kBorder);
    float down[4], across[4], brightness = 0, coverage = 0;
    cubic_weights(y - static_cast<float>(row), down);
    cubic_weights(x - static_cast<float>(column), across);
    const float* p = maps + (row - 1) * stride + 2 * (column - 1);
    for (int i = 0; i < 4; ++i, p += stride) {
      brightness += down[i] * (across[0] * p[0] + across[1] * p[2] + across[2] * p[4] + across[3] * p[6]);
      coverage += down[i] * (across[0] * p[1] + across[1] * p[3] + across[2] * p[5] + across[3] * p[7]);
    }
    return {0, brightness, clamped(coverage, 0, 1)};
  }
};

/// Returns the light of a pixel of a view; pixels are counted over [size, size].
ON_DEVICE float light_of(const Scenes& scenes, int scene, const Camera& camera, int pixel) {
  const float corner = -0.5F * static_cast<float>(scenes.size - 1);
  const float y = static_cast<float>(pixel / scenes.size) + corner,
              x = static_cast<float>(pixel % scenes.size) + corner;
  const int back = scenes.first[scene];
  float light = 0, through = 1;
  for (int i = scenes.first[scene + 1]; i-- > back && through > kHidden;) {
    const Seen seen = camera.see(scenes.layer(i), y, x);
    const float coverage = i == back ? 1 : seen.coverage;
    light += through * coverage * seen.brightness;
    through *= 1 - coverage;
  }
  return clamped(light, 0, 1);
}

/// Returns the disparity of the nearest layer that covers more than half of a pixel.
ON_DEVICE float disparity_of(const Scenes& scenes, int scene, const Camera& camera, int pixel) {
  const float corner = -0.5F * static_cast<float>(scenes.size - 1);
  const float y = static_cast<float>(pixel / scenes.size) + corner,
              x = static_cast<float>(pixel % scenes.size) + corner;
  const int back = scenes.first[scene];
  for (int i = scenes.first[scene + 1] - 1;; --i) {
    const Seen seen = camera.see(scenes.layer(i), y, x);
    if (i == back || seen.coverage > 0.5F) return seen.disparity;
  }
}

/// Writes one pixel of views, [scene, view, y, x], or of the disparity for a single viewpoint.
ON_DEVICE void render_pixel(const Scenes& scenes, const float* viewpoints, int views, bool is_disparity, int at,
                            float* out) {
  const int pixels = scenes.size * scenes.size, picture = at / pixels, view = picture % views, scene = picture / views;
  const Camera camera{scenes.side, viewpoints[2 * view], viewpoints[2 * view + 1]};
  out[at] =
      is_disparity ? disparity_of(scenes, scene, camera, at % pixels) : light_of(scenes, scene, camera, at % pixels);
}

#ifdef __CUDACC__
__global__ void render_pixels(Scenes scenes, const float* viewpoints, int views, bool is_disparity, int count,
                              float* out) {
  const int at = static_cast<int>(blockIdx.x * blockDim.x + threadIdx.x);
  if (at < count) render_pixel(scenes, viewpoints, views, is_disparity, at, out);
}
#endif

}  // namespace

extern "C" {

/// Renders the views, or the disparity of one view, of `number` scenes from viewpoints [views, 2] (y, x) into
/// [number, views, size, size]. Returns 0, or the error of the GPU.
int render(int number, const float* planes, const float* maps, const float* reliefs, const int* first, int side,
           int size, const float* viewpoints, int views, int is_disparity, float* out, void* stream) {
  const Scenes scenes{planes, maps, reliefs, first, side, size};
  const int count = number * views * size * size;
#ifdef __CUDACC__
  render_pixels<<<(count + 255) / 256, 256, 0, static_cast<cudaStream_t>(stream)>>>(scenes, viewpoints, views,
                                                                                    is_disparity != 0, count, out);
  return cudaGetLastError();
#else
  static_cast<void>(stream);
  for (int at = 0; at < count; ++at) render_pixel(scenes, viewpoints, views, is_disparity != 0, at, out);
  return 0;
#endif
}

}  // extern "C"
