// SPDX-License-Identifier: MIT
#include "e2lf/learn/synthesiser.h"

#include <algorithm>
#include <cmath>

#include "e2lf/learn/surface_maps.h"

namespace e2lf::learn {
namespace {

constexpr int64_t kViewsPerSide = 8;
constexpr double kFarthestView = 3.5;  // view steps from the centre of the 8x8 grid

/// Disparity over the central picture: centre + slope . (position - centre of the picture), px per view step.
struct Plane {
  double centre = 0, slope_y = 0, slope_x = 0;
};

Plane random_plane(double low, double high, const SynthesiserOptions& options, Draws& draws) {
  Plane plane{.centre = draws.uniform(low, high)};
  if (draws.chance(options.slant_share)) {
    // The disparity stays within its limit at the corners.
    const double room = (options.max_disparity - std::abs(plane.centre)) / static_cast<double>(options.size);
    plane.slope_y = draws.uniform(-1, 1) * std::min(room, 0.025);
    plane.slope_x = draws.uniform(-1, 1) * std::min(room, 0.025);
  }
  return plane;
}

/// Where each ray meets a plane: sampling positions [64, size, size, 2] (x, y) for grid_sample into a map of `side`.
torch::Tensor ray_positions(const Plane& plane, int64_t size, int64_t side, torch::Device device) {
  const auto options = torch::device(device).dtype(torch::kFloat);
  const auto pixel = torch::arange(size, options) - 0.5 * static_cast<double>(size - 1);
  const auto view = torch::arange(kViewsPerSide, options) - kFarthestView;
  const auto y = pixel.view({1, 1, size, 1}), x = pixel.view({1, 1, 1, size});
  const auto view_y = view.view({kViewsPerSide, 1, 1, 1}), view_x = view.view({1, kViewsPerSide, 1, 1});
  // A point q of the central picture appears at p = q + view * d(q) with d(q) = centre + slope . q; solved for d.
  const auto tilt = plane.slope_y * view_y + plane.slope_x * view_x;
  const auto disparity = (plane.centre + plane.slope_y * y + plane.slope_x * x) / (1.0 + tilt);
  const double unit = 2.0 / static_cast<double>(side);
  const auto shape = {kViewsPerSide, kViewsPerSide, size, size};
  return torch::stack(
             {((x - view_x * disparity) * unit).expand(shape), ((y - view_y * disparity) * unit).expand(shape)}, -1)
      .flatten(0, 1);
}

/// maps [channels, side, side] seen through all views: [64, channels, size, size]. Bicubic: bilinear interpolation
/// takes the finest detail away wherever a view looks between pixels, and cameras do not.
torch::Tensor project(const torch::Tensor& maps, const torch::Tensor& positions) {
  return at::grid_sampler_2d(maps.unsqueeze(0).expand({positions.size(0), -1, -1, -1}), positions,
                             /*interpolation_mode=bicubic*/ 2, /*padding_mode=border*/ 1, /*align_corners=*/false);
}

}  // namespace

torch::Tensor synthesise(const std::vector<torch::Tensor>& textures, const SynthesiserOptions& options, uint64_t seed,
                         torch::Device device) {
  torch::NoGradGuard no_grad;
  torch::manual_seed(seed);
  Draws draws(seed, 0);
  const auto side = options.size + 2 * static_cast<int64_t>(std::ceil(kFarthestView * options.max_disparity));
  const auto texture = [&] {
    const bool photo = !textures.empty() && !draws.chance(options.procedural_share);
    return photo ? photo_texture(textures, side, draws) : procedural_texture(side, draws, device);
  };

  // A third of the scenes has the shallow depth of a plenoptic camera.
  const double limit = options.max_disparity * (draws.chance(0.33) ? 0.3 : 1.0);
  const double high = draws.uniform(-0.5 * limit, limit), low = draws.uniform(-limit, high);
  const auto num_layers = 1 + draws.below(static_cast<uint64_t>(options.max_layers));
  std::vector<Plane> planes;
  for (uint32_t i = 0; i < num_layers; ++i) planes.push_back(random_plane(low, high, options, draws));
  // Back to front: nearer surfaces have the smaller disparity.
  std::sort(planes.begin(), planes.end(), [](const Plane& a, const Plane& b) { return a.centre > b.centre; });

  torch::Tensor picture;
  for (const Plane& plane : planes) {
    const auto brightness = texture();
    const auto positions = ray_positions(plane, options.size, side, device);
    if (!picture.defined()) {
      picture = project(brightness.unsqueeze(0), positions).squeeze(1);
      continue;
    }
    const auto layer = project(torch::stack({brightness, coverage(brightness, draws)}), positions);
    picture = torch::lerp(picture, layer.select(1, 0), layer.select(1, 1).clamp(0.0, 1.0));
  }
  if (draws.chance(options.highlight_share)) {
    const auto positions = ray_positions({.centre = draws.uniform(low, high)}, options.size, side, device);
    picture = picture + project(highlights(side, draws, device).unsqueeze(0), positions).squeeze(1);
  }
  return picture.mul(255.0).round().clamp(0.0, 255.0).to(torch::kByte);
}

}  // namespace e2lf::learn
