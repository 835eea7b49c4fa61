// SPDX-License-Identifier: MIT
#include "e2lf/learn/data/surfaces.h"

#include <ATen/Parallel.h>

#include "e2lf/base/contract.h"
#if E2LF_LEARN_KERNELS
#include "e2lf/learn/data/dataset.h"
#include "e2lf/learn/data/view_renderer.h"
#endif

namespace e2lf::learn {
namespace {

constexpr double kCentralView = 3.5;

/// Returns the points where the rays meet a plane, as sampling positions [64, size, size, 2] (x, y) of grid_sample in a
/// map of `side` px.
torch::Tensor ray_positions(const Plane& plane, int64_t size, int64_t side, torch::Device device) {
  const auto options = torch::device(device).dtype(torch::kFloat);
  const auto pixel = torch::arange(size, options) - 0.5 * static_cast<double>(size - 1);
  const auto view = torch::arange(kViewsPerSide, options) - kCentralView;
  const auto y = pixel.view({1, 1, size, 1}) - plane.offset_y, x = pixel.view({1, 1, 1, size}) - plane.offset_x;
  const auto view_y = view.view({kViewsPerSide, 1, 1, 1}), view_x = view.view({1, kViewsPerSide, 1, 1});
  // A point q of the central view appears at p = q + view * d(q) with d(q) = centre + slope . q; solved for d.
  const auto tilt = plane.slope_y * view_y + plane.slope_x * view_x;
  const auto disparity = (plane.centre + plane.slope_y * y + plane.slope_x * x) / (1.0 + tilt);
  const double unit = 2.0 / static_cast<double>(side);
  const auto shape = {kViewsPerSide, kViewsPerSide, size, size};
  return torch::stack(
             {((x - view_x * disparity) * unit).expand(shape), ((y - view_y * disparity) * unit).expand(shape)}, -1)
      .flatten(0, 1);
}

/// Samples maps [channels, side, side] for all views: [64, channels, size, size].
torch::Tensor project(const torch::Tensor& maps, const torch::Tensor& positions) {
  return at::grid_sampler_2d(maps.unsqueeze(0).expand({positions.size(0), -1, -1, -1}), positions,
                             /*interpolation_mode=bicubic*/ 2, /*padding_mode=border*/ 1, /*align_corners=*/false);
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

torch::Tensor render_views(const std::vector<Surface>& surfaces, int64_t size) {
  std::vector<torch::Tensor> maps;
  std::vector<MappedPlane> planes;
  for (const Surface& surface : surfaces) {
    planes.push_back({surface.plane, maps.emplace_back(interleave(surface)).data_ptr<float>()});
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

}  // namespace

torch::Tensor views_of_reference(const std::vector<Surface>& surfaces, int64_t size) {
  require_surfaces(surfaces);
  torch::Tensor picture;
  for (const Surface& surface : surfaces) {
    const auto& brightness = surface.brightness;
    const auto positions = ray_positions(surface.plane, size, brightness.size(0), brightness.device());
    if (!picture.defined()) {
      picture = project(brightness.unsqueeze(0), positions).squeeze(1);
      continue;
    }
    const auto layer = project(torch::stack({brightness, surface.coverage}), positions);
    picture = torch::lerp(picture, layer.select(1, 0), layer.select(1, 1).clamp(0.0, 1.0));
  }
  return picture;
}

torch::Tensor views_of(const std::vector<Surface>& surfaces, int64_t size) {
  require_surfaces(surfaces);
#if E2LF_LEARN_KERNELS
  if (surfaces.front().brightness.device().is_cpu()) return render_views(surfaces, size);
#endif
  return views_of_reference(surfaces, size);
}

}  // namespace e2lf::learn
