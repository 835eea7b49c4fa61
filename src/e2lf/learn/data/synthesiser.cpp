// SPDX-License-Identifier: MIT
#include "e2lf/learn/data/synthesiser.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

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

/// What is drawn for a scene.
struct SceneDraft {
  std::vector<Surface> surfaces;     ///< back to front
  std::vector<Surface> reflections;  ///< whose brightness is added
};

SceneDraft draft_scene(const std::vector<torch::Tensor>& textures, const SynthesiserOptions& options, uint64_t seed,
                       torch::Device device) {
  torch::manual_seed(seed);
  Draws draws(seed, 0);
  const auto side = options.size + 2 * static_cast<int64_t>(std::ceil(kFarthestView * options.max_disparity));
  const auto texture = [&] {
    const bool photo = !textures.empty() && !draws.chance(options.procedural_share);
    return photo ? photo_texture(textures, side, draws) : procedural_texture(side, draws, device);
  };

  SceneDraft draft;
  const double limit = options.max_disparity * kDepths[draws.below(kDepths.size())];
  const double high = draws.uniform(-0.5 * limit, limit), low = draws.uniform(-limit, high);
  const auto num_layers = 1 + draws.below(static_cast<uint64_t>(options.max_layers));
  std::vector<Plane> planes;
  for (uint32_t i = 0; i < num_layers; ++i) planes.push_back(random_plane(low, high, options, draws));
  // Back to front: nearer surfaces have the smaller disparity.
  std::sort(planes.begin(), planes.end(), [](const Plane& a, const Plane& b) { return a.centre > b.centre; });

  for (const Plane& plane : planes) {
    const auto brightness = texture();
    draft.surfaces.push_back(
        {plane, brightness, draft.surfaces.empty() ? torch::Tensor() : coverage(brightness, draws)});
  }
  if (draws.chance(options.highlight_share)) {
    const Plane reflection{.centre = draws.uniform(low, high)};
    draft.reflections.push_back({reflection, highlights(side, draws, device), {}});
  }
  return draft;
}

torch::Tensor render(const SceneDraft& draft, int64_t size) {
  auto picture = views_of(draft.surfaces, size);
  if (!draft.reflections.empty()) picture = picture + views_of(draft.reflections, size);
  return picture.mul(255.0).round().clamp(0.0, 255.0).to(torch::kByte);
}

/// The velocity of a surface, px per cycle.
struct Velocity {
  double y = 0, x = 0;
};

Velocity random_velocity(double most, Draws& draws) {
  const double speed = draws.uniform(0.0, most), angle = draws.uniform(0.0, 2.0 * std::numbers::pi);
  return {speed * std::sin(angle), speed * std::cos(angle)};
}

void move(std::vector<Surface>& surfaces, const std::vector<Velocity>& velocities, double cycles) {
  for (size_t i = 0; i < surfaces.size(); ++i) {
    surfaces[i].plane.offset_y = velocities[i].y * cycles;
    surfaces[i].plane.offset_x = velocities[i].x * cycles;
  }
}

}  // namespace

MovingScene synthesise(const std::vector<torch::Tensor>& textures, const SynthesiserOptions& options, uint64_t seed,
                       torch::Device device, const std::vector<double>& times) {
  torch::NoGradGuard no_grad;
  SceneDraft draft = draft_scene(textures, options, seed, device);
  MovingScene scene{render(draft, options.size), {}};
  Draws draws(seed, 1);  // another stream, so that the scene itself does not depend on its motion
  if (times.empty() || options.motion_px_per_cycle <= 0.0 || draws.chance(options.still_share)) return scene;
  // A moving camera moves everything alike.
  const bool is_of_camera = draws.chance(0.5);
  std::vector<Velocity> velocities;
  for (size_t i = 0; i < draft.surfaces.size(); ++i) {
    velocities.push_back(i > 0 && is_of_camera ? velocities.front()
                                               : random_velocity(options.motion_px_per_cycle, draws));
  }
  std::vector<torch::Tensor> pictures;
  for (const double time : times) {
    move(draft.surfaces, velocities, time);
    move(draft.reflections, velocities, time);
    pictures.push_back(render(draft, options.size));
  }
  scene.at_times = torch::stack(pictures);
  return scene;
}

}  // namespace e2lf::learn
