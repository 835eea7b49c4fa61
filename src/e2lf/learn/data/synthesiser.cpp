// SPDX-License-Identifier: MIT
#include "e2lf/learn/data/synthesiser.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "e2lf/learn/data/surface_maps.h"
#include "e2lf/learn/data/surfaces.h"

namespace e2lf::learn {
namespace {

constexpr double kFarthestView = 3.5;  // view steps from the centre of the 8x8 grid
/// Fractions of the largest disparity that limit a scene, with equal probability. The smallest corresponds to the depth
/// range of a plenoptic camera.
constexpr std::array kDepths = {0.3, 0.65, 1.0};

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

  const double limit = options.max_disparity * kDepths[draws.below(kDepths.size())];
  const double high = draws.uniform(-0.5 * limit, limit), low = draws.uniform(-limit, high);
  const auto num_layers = 1 + draws.below(static_cast<uint64_t>(options.max_layers));
  std::vector<Plane> planes;
  for (uint32_t i = 0; i < num_layers; ++i) planes.push_back(random_plane(low, high, options, draws));
  // Back to front: nearer surfaces have the smaller disparity.
  std::sort(planes.begin(), planes.end(), [](const Plane& a, const Plane& b) { return a.centre > b.centre; });

  std::vector<Surface> surfaces;
  for (const Plane& plane : planes) {
    const auto brightness = texture();
    surfaces.push_back({plane, brightness, surfaces.empty() ? torch::Tensor() : coverage(brightness, draws)});
  }
  auto picture = views_of(surfaces, options.size);
  if (draws.chance(options.highlight_share)) {
    const Plane reflection{.centre = draws.uniform(low, high)};
    picture = picture + views_of({{reflection, highlights(side, draws, device), {}}}, options.size);
  }
  return picture.mul(255.0).round().clamp(0.0, 255.0).to(torch::kByte);
}

}  // namespace e2lf::learn
