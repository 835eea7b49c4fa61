// SPDX-License-Identifier: MIT
#include "e2lf/learn/data/synthesiser.h"

#include <ATen/Parallel.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "e2lf/base/result.h"
#include "e2lf/learn/data/dataset.h"

namespace e2lf::learn {
namespace {

constexpr double kCentralView = 3.5;

/// Coordinates of the pixels from the centre, px: y is [side, 1], x is [1, side].
struct Coordinates {
  torch::Tensor y, x;
};

Coordinates centred_coordinates(int64_t side, torch::Device device) {
  const auto axis =
      torch::arange(side, torch::device(device).dtype(torch::kFloat)) - 0.5 * static_cast<double>(side - 1);
  return {axis.unsqueeze(1), axis.unsqueeze(0)};
}

/// The viewpoints of views in one dimension, each coordinate [views, 1, 1].
struct ViewPoints {
  torch::Tensor y, x;
};

ViewPoints all_views(torch::Device device) {
  const auto axis = torch::arange(kViewsPerSide, torch::device(device).dtype(torch::kFloat)) - kCentralView;
  return {axis.repeat_interleave(kViewsPerSide).view({-1, 1, 1}), axis.repeat({kViewsPerSide}).view({-1, 1, 1})};
}

/// Samples maps [channels, side, side] at positions [views, size, size, 2]: [views, channels, size, size].
torch::Tensor project(const torch::Tensor& maps, const torch::Tensor& positions, bool is_cubic = true) {
  return at::grid_sampler_2d(maps.unsqueeze(0).expand({positions.size(0), -1, -1, -1}), positions,
                             /*interpolation_mode=bicubic or bilinear*/ is_cubic ? 2 : 0, /*padding_mode=border*/ 1,
                             /*align_corners=*/false);
}

/// The points where rays meet a surface, as sampling positions [views, size, size, 2] (x, y) of grid_sample in its
/// maps, and the disparity there, [views, size, size].
struct Hits {
  torch::Tensor positions, disparity;
};

Hits trace(const Surface& surface, int64_t size, const ViewPoints& from) {
  const Plane& plane = surface.plane;
  const Coordinates pixel = centred_coordinates(size, from.y.device());
  const auto y = pixel.y - plane.offset_y, x = pixel.x - plane.offset_x;
  // A point q of the central view appears at p = q + view * d(q) with d(q) = centre + slope . q; solved for d.
  const auto tilt = plane.slope_y * from.y + plane.slope_x * from.x;
  const auto of_plane = (plane.centre + plane.slope_y * y + plane.slope_x * x) / (1.0 + tilt);
  const double unit = 2.0 / static_cast<double>(surface.brightness.size(0));
  const std::vector<int64_t> shape = {from.y.size(0), size, size};
  const auto positions_at = [&](const torch::Tensor& disparity) {
    return torch::stack(
        {((x - from.x * disparity) * unit).expand(shape), ((y - from.y * disparity) * unit).expand(shape)}, -1);
  };
  Hits hits{positions_at(of_plane), of_plane.expand(shape)};
  if (!surface.relief.defined()) return hits;
  for (int step = 0; step < kReliefSteps; ++step) {
    const auto relief = project(surface.relief.unsqueeze(0), hits.positions, /*is_cubic=*/false).squeeze(1);
    hits.disparity = of_plane + relief;
    hits.positions = positions_at(hits.disparity);
  }
  return hits;
}

void require_surfaces(const std::vector<Surface>& surfaces) {
  E2LF_REQUIRE(!surfaces.empty() && !surfaces.front().coverage.defined(), "the surface behind all has no coverage");
  const auto shape = surfaces.front().brightness.sizes();
  E2LF_REQUIRE(shape.size() == 2 && shape[0] == shape[1], "maps are square");
  for (size_t i = 1; i < surfaces.size(); ++i) {
    E2LF_REQUIRE(surfaces[i].coverage.defined(), "every surface but the one behind all has a coverage");
    E2LF_REQUIRE(surfaces[i].brightness.sizes() == shape && surfaces[i].coverage.sizes() == shape,
                 "maps have one size");
  }
}

#if E2LF_LEARN_KERNELS
/// Returns the two maps of a surface side by side and extended beyond the border, as render_view() expects them.
torch::Tensor interleave(const Surface& surface) {
  const auto coverage = surface.coverage.defined() ? surface.coverage : torch::ones_like(surface.brightness);
  const auto maps = torch::stack({surface.brightness, coverage}).unsqueeze(0);
  constexpr auto border = static_cast<int64_t>(kMapBorder);
  return at::replication_pad2d(maps, {border, border, border, border})[0].permute({1, 2, 0}).contiguous();
}

/// Returns MappedPlane::may_cover of a surface: whether one of the taps around a position has coverage. A relief moves
/// the position.
torch::Tensor where_it_may_cover(const Surface& surface) {
  int64_t reach = 0;
  if (surface.relief.defined()) {
    reach = 1 + static_cast<int64_t>(std::ceil(kCentralView * surface.relief.abs().max().item<double>()));
  }
  constexpr auto border = static_cast<int64_t>(kMapBorder);
  const auto padded = at::replication_pad2d(surface.coverage.unsqueeze(0), {border, border, border, border});
  const int64_t taps = 4 + 2 * reach;
  const auto across = at::max_pool2d(padded, {1, taps}, {1, 1}, {0, reach});
  return at::max_pool2d(across, {taps, 1}, {1, 1}, {reach, 0})[0].gt(0).to(torch::kByte).contiguous();
}

torch::Tensor render_views(const std::vector<Surface>& surfaces, int64_t size) {
  std::vector<torch::Tensor> maps;
  std::vector<MappedPlane> planes;
  for (const Surface& surface : surfaces) {
    E2LF_REQUIRE(!surface.relief.defined() || surface.relief.is_contiguous(), "reliefs are contiguous");
    planes.push_back({surface.plane, maps.emplace_back(interleave(surface)).data_ptr<float>(),
                      surface.relief.defined() ? surface.relief.data_ptr<float>() : nullptr});
    if (surface.coverage.defined()) {
      planes.back().may_cover = maps.emplace_back(where_it_may_cover(surface)).data_ptr<uint8_t>();
    }
  }
  const auto side = static_cast<size_t>(surfaces.front().brightness.size(0)), pixels = static_cast<size_t>(size);
  auto views = torch::empty({kViewsPerSide * kViewsPerSide, size, size});
  at::parallel_for(0, views.size(0), 1, [&](int64_t begin, int64_t end) {
    for (int64_t view = begin; view < end; ++view) {
      const ViewPoint from{static_cast<double>(view / kViewsPerSide) - kCentralView,
                           static_cast<double>(view % kViewsPerSide) - kCentralView};
      render_view(planes, side, from, pixels, views.data_ptr<float>() + view * size * size);
    }
  });
  return views;
}
#endif

/// Returns the signed distance of each pixel from a line of random direction, px.
torch::Tensor distance_from_line(const Coordinates& at, double offset_px, Draws& draws) {
  const double angle = draws.uniform(0, 2 * std::numbers::pi);
  return at.x * std::cos(angle) + at.y * std::sin(angle) + offset_px;
}

torch::Tensor stripes(const Coordinates& at, double period_px, double duty, Draws& draws) {
  const auto position = distance_from_line(at, draws.uniform(0, period_px), draws) / period_px;
  const auto phase = position - position.floor();
  return (0.5 * duty - (phase - 0.5).abs()) * period_px;  // px inside a stripe
}

/// Divides a field of arbitrary units by its mean slope, so that its values near its edges are in px.
torch::Tensor in_px(const torch::Tensor& field) {
  const auto slope = field.diff(1, 0).abs().mean() + field.diff(1, 1).abs().mean();
  return field / (0.7 * slope + 1e-6);
}

torch::Tensor random_tone(const torch::Tensor& texture, Draws& draws) {
  return texture.clamp(0.0, 1.0).pow(draws.log_uniform(0.7, 2.0));
}

/// Returns a tone that varies slowly over the surface. Without noise, such surfaces cause bands of equal counts, whose
/// edges determine the tone between them. Photographs are too rough to teach this.
torch::Tensor smooth_shading(int64_t side, Draws& draws, torch::Device device,
                             const std::optional<at::Generator>& generator) {
  const double tone = draws.log_uniform(0.05, 0.8);
  const auto shape = smooth_noise(side, draws.log_uniform(20, 200), device, generator);
  return (tone * torch::exp(draws.log_uniform(0.05, 0.5) * shape)).clamp(0.0, 1.0);
}

}  // namespace

torch::Tensor smooth_noise(int64_t side, double feature_px, torch::Device device,
                           const std::optional<at::Generator>& generator) {
  const auto cells = std::max<int64_t>(2, static_cast<int64_t>(static_cast<double>(side) / feature_px) + 1);
  const auto noise = generator ? torch::randn({1, 1, cells, cells}, *generator).to(device)
                               : torch::randn({1, 1, cells, cells}, torch::device(device));
  const auto map = at::upsample_bicubic2d(noise, {side, side}, /*align_corners=*/true)[0][0];
  return map / (map.std() + 1e-3);
}

torch::Tensor views_of_reference(const std::vector<Surface>& surfaces, int64_t size) {
  require_surfaces(surfaces);
  torch::Tensor picture;
  for (const Surface& surface : surfaces) {
    const auto& brightness = surface.brightness;
    const auto positions = trace(surface, size, all_views(brightness.device())).positions;
    if (!picture.defined()) {
      picture = project(brightness.unsqueeze(0), positions).squeeze(1);
      continue;
    }
    const auto layer = project(torch::stack({brightness, surface.coverage}), positions);
    picture = torch::lerp(picture, layer.select(1, 0), layer.select(1, 1).clamp(0.0, 1.0));
  }
  return picture;
}

torch::Tensor disparity_of(const std::vector<Surface>& surfaces, int64_t size, const ViewPoint& from) {
  require_surfaces(surfaces);
  const auto one = torch::ones({1, 1, 1}, torch::device(surfaces.front().brightness.device()));
  torch::Tensor seen;
  for (const Surface& surface : surfaces) {
    const Hits hits = trace(surface, size, {one * from.y, one * from.x});
    seen = seen.defined()
               ? torch::where(project(surface.coverage.unsqueeze(0), hits.positions)[0] > 0.5, hits.disparity, seen)
               : hits.disparity;
  }
  return seen[0];
}

torch::Tensor views_of(const std::vector<Surface>& surfaces, int64_t size) {
  require_surfaces(surfaces);
#if E2LF_LEARN_KERNELS
  if (surfaces.front().brightness.device().is_cpu()) return render_views(surfaces, size);
#endif
  return views_of_reference(surfaces, size);
}

torch::Tensor photo_texture(const std::vector<torch::Tensor>& photos, int64_t side, Draws& draws) {
  const auto& photo = photos[draws.below(photos.size())];
  const auto height = photo.size(0), width = photo.size(1);
  // Nearly always reduced in size, which makes them sharp at the pixel level; at full size photographs seldom are.
  const auto wanted = static_cast<int64_t>(static_cast<double>(side) * draws.log_uniform(0.9, 3.0));
  const auto crop = std::min({wanted, height, width});
  const auto y = static_cast<int64_t>(draws.below(static_cast<uint64_t>(height - crop + 1)));
  const auto x = static_cast<int64_t>(draws.below(static_cast<uint64_t>(width - crop + 1)));
  auto piece = photo.slice(0, y, y + crop).slice(1, x, x + crop);
  if (draws.chance(0.5)) piece = piece.flip({0});
  if (draws.chance(0.5)) piece = piece.transpose(0, 1);
  const auto batch = piece.to(torch::kFloat).div(255.0).unsqueeze(0).unsqueeze(0).contiguous();
  return random_tone(at::_upsample_bilinear2d_aa(batch, {side, side}, /*align_corners=*/false)[0][0], draws);
}

torch::Tensor procedural_texture(int64_t side, Draws& draws, torch::Device device,
                                 const std::optional<at::Generator>& generator) {
  const auto kind = draws.below(6);
  if (kind == 0) return torch::full({side, side}, draws.uniform(0.02, 1.0), torch::device(device));
  if (kind >= 4) return smooth_shading(side, draws, device, generator);
  if (kind == 1) {
    auto sum = torch::zeros({side, side}, torch::device(device));
    double amplitude = 0.25;
    for (double feature_px = draws.log_uniform(8, 64); feature_px > 1.5; feature_px /= 2.0) {
      sum = sum + amplitude * smooth_noise(side, feature_px, device, generator);
      amplitude *= draws.uniform(0.5, 0.8);
    }
    return random_tone(0.5 + sum, draws);
  }
  const auto at = centred_coordinates(side, device);
  auto inside = stripes(at, draws.log_uniform(4, 40), draws.uniform(0.2, 0.8), draws);
  if (kind == 3) {  // a grid or checks: two sets of stripes
    const auto across = stripes(at, draws.log_uniform(4, 40), draws.uniform(0.2, 0.8), draws);
    inside = draws.chance(0.5) ? torch::minimum(inside, across) : inside * across.sign();
  }
  const double dark = draws.uniform(0.0, 1.0), bright = draws.uniform(0.0, 1.0);
  return dark + (bright - dark) * (inside + 0.5).clamp(0.0, 1.0);
}

torch::Tensor coverage(const torch::Tensor& texture, Draws& draws, const std::optional<at::Generator>& generator) {
  const auto side = texture.size(0);
  const auto device = texture.device();
  const auto at = centred_coordinates(side, device);
  const double half = 0.5 * static_cast<double>(side);
  torch::Tensor inside;  // px inside the edge
  switch (draws.below(5)) {
    case 0:
      inside = distance_from_line(at, draws.uniform(-0.7, 0.3) * half, draws);
      for (auto lines = draws.below(3); lines > 0; --lines) {
        inside = torch::minimum(inside, distance_from_line(at, draws.uniform(0.0, 0.8) * half, draws));
      }
      break;
    case 1: {
      const double a = draws.log_uniform(4, half), b = draws.log_uniform(4, half);
      const auto y = (at.y - draws.uniform(-0.8, 0.8) * half) / a, x = (at.x - draws.uniform(-0.8, 0.8) * half) / b;
      inside = (1.0 - (y * y + x * x + 1e-6).sqrt()) * std::min(a, b);
      break;
    }
    case 2:
      inside = stripes(at, draws.log_uniform(8, 60), draws.uniform(0.1, 0.6), draws);
      break;
    case 3:
      inside = in_px(smooth_noise(side, draws.log_uniform(6, 50), device, generator) - draws.uniform(-0.3, 1.2));
      break;
    default:
      inside = in_px(texture - texture.mean() - draws.uniform(-0.3, 0.8) * texture.std());
  }
  const double edge_px = draws.chance(0.7) ? 1.0 : draws.log_uniform(1.5, 8.0);
  return (inside / edge_px + 0.5).clamp(0.0, 1.0) * (draws.chance(0.1) ? draws.uniform(0.3, 0.9) : 1.0);
}

torch::Tensor highlights(int64_t side, Draws& draws, torch::Device device) {
  const auto at = centred_coordinates(side, device);
  const double half = 0.5 * static_cast<double>(side);
  auto sum = torch::zeros({side, side}, torch::device(device));
  for (auto spots = 1 + draws.below(5); spots > 0; --spots) {
    const double radius = draws.log_uniform(1.0, 10.0);
    const auto y = (at.y - draws.uniform(-1, 1) * half) / radius, x = (at.x - draws.uniform(-1, 1) * half) / radius;
    sum = sum + draws.uniform(0.2, 1.0) * torch::exp(-0.5 * (y * y + x * x));
  }
  return sum.clamp_max(1.0);
}

// Random scenes.
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
