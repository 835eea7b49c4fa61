// SPDX-License-Identifier: MIT
#include "e2lf/learn/surfaces.h"

#include <ATen/Parallel.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace e2lf::learn {
namespace {

constexpr int64_t kViewsPerSide = 8;
constexpr double kCentralView = 3.5;
constexpr int64_t kBorder = 3;          // px that maps are continued by, for the taps of the interpolation
constexpr uint32_t kSteps = 1024;       // positions between two pixels that are told apart
constexpr float kHidden = 1.0F / 1024;  // less light than this from behind makes no grey level

/// Where each ray meets a plane: sampling positions [64, size, size, 2] (x, y) for grid_sample into a map of `side`.
torch::Tensor ray_positions(const Plane& plane, int64_t size, int64_t side, torch::Device device) {
  const auto options = torch::device(device).dtype(torch::kFloat);
  const auto pixel = torch::arange(size, options) - 0.5 * static_cast<double>(size - 1);
  const auto view = torch::arange(kViewsPerSide, options) - kCentralView;
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

/// maps [channels, side, side] seen through all views: [64, channels, size, size].
torch::Tensor project(const torch::Tensor& maps, const torch::Tensor& positions) {
  return at::grid_sampler_2d(maps.unsqueeze(0).expand({positions.size(0), -1, -1, -1}), positions,
                             /*interpolation_mode=bicubic*/ 2, /*padding_mode=border*/ 1, /*align_corners=*/false);
}

/// A surface's two maps side by side, continued over the border: [side + 2 border, side + 2 border, 2].
torch::Tensor interleave(const Surface& surface) {
  const auto coverage = surface.coverage.defined() ? surface.coverage : torch::ones_like(surface.brightness);
  const auto maps = torch::stack({surface.brightness, coverage}).unsqueeze(0);
  return at::replication_pad2d(maps, {kBorder, kBorder, kBorder, kBorder})[0].permute({1, 2, 0}).contiguous();
}

/// Weights of four neighbours at `t` in [0, 1] behind the second: Keys' cubic with a = -0.75, as torch has it.
std::array<float, 4> cubic_weights(float t) {
  constexpr float a = -0.75F;
  const auto near = [](float x) { return ((a + 2.0F) * x - (a + 3.0F)) * x * x + 1.0F; };
  const auto far = [](float x) { return ((a * x - 5.0F * a) * x + 8.0F * a) * x - 4.0F * a; };
  return {far(t + 1.0F), near(t), near(1.0F - t), far(2.0F - t)};
}

/// Four neighbours of two maps side by side.
using Eight [[gnu::vector_size(32)]] = float;

using WeightTable = std::array<Eight, kSteps>;

const WeightTable& weight_table() {
  static const WeightTable table = [] {
    WeightTable weights;
    for (size_t i = 0; i < kSteps; ++i) {
      const auto [a, b, c, d] = cubic_weights(static_cast<float>(i) / kSteps);
      weights[i] = Eight{a, a, b, b, c, c, d, d};
    }
    return weights;
  }();
  return table;
}

struct Sample {
  float brightness, coverage;
};

/// (y, x) in steps of 1 / kSteps px.
inline Sample sample(const float* map, int32_t side, const WeightTable& table, float y, float x) {
  const auto in_steps = [side](float at) {  // from one px before the map, where the border has begun
    return static_cast<uint32_t>((std::clamp(at, -1.0F, static_cast<float>(side)) + 1.0F) * kSteps + 0.5F);
  };
  const uint32_t from_top = in_steps(y), from_left = in_steps(x);
  const auto &weights_y = table[from_top % kSteps], &weights_x = table[from_left % kSteps];
  const size_t stride = 2 * (static_cast<size_t>(side) + 2 * kBorder);
  const float* tap = map + (from_top / kSteps + kBorder - 2) * stride + 2 * (from_left / kSteps + kBorder - 2);
  Eight sum = {};
  for (int i = 0; i < 8; i += 2, tap += stride) {
    Eight row;
    std::memcpy(&row, tap, sizeof(row));
    sum += weights_y[i] * row;
  }
  sum *= weights_x;
  return {(sum[0] + sum[2]) + (sum[4] + sum[6]), (sum[1] + sum[3]) + (sum[5] + sum[7])};
}

/// A plane along one row of one view: positions in its map go in equal steps.
struct RowOfRays {
  float y, x, step_y, step_x;
};

RowOfRays row_of_rays(const Plane& plane, double view_y, double view_x, int64_t row, int64_t size, int64_t side) {
  const double first = -0.5 * static_cast<double>(size - 1), y = static_cast<double>(row) + first;
  const double middle = 0.5 * static_cast<double>(side - 1);
  const double shrink = 1.0 / (1.0 + plane.slope_y * view_y + plane.slope_x * view_x);
  const double disparity = (plane.centre + plane.slope_y * y + plane.slope_x * first) * shrink;
  const double step = plane.slope_x * shrink;
  return {static_cast<float>(y - view_y * disparity + middle), static_cast<float>(first - view_x * disparity + middle),
          static_cast<float>(-view_y * step), static_cast<float>(1.0 - view_x * step)};
}

/// One view, front to back until nothing behind can be seen.
#if defined(__x86_64__)
[[gnu::target_clones("avx2", "default")]]
#endif
void render_view(const std::vector<Surface>& surfaces, const std::vector<const float*>& maps, double view_y,
                 double view_x, int64_t size, float* out) {
  const int64_t side = surfaces.front().brightness.size(0);
  const WeightTable& table = weight_table();
  std::vector<RowOfRays> rays(surfaces.size());
  for (int64_t row = 0; row < size; ++row) {
    for (size_t i = 0; i < rays.size(); ++i) {
      rays[i] = row_of_rays(surfaces[i].plane, view_y, view_x, row, size, side);
    }
    for (int64_t column = 0; column < size; ++column) {
      const auto at = static_cast<float>(column);
      float light = 0, through = 1;
      for (size_t i = surfaces.size(); i-- > 0 && through > kHidden;) {
        const auto seen = sample(maps[i], static_cast<int32_t>(side), table, rays[i].y + at * rays[i].step_y,
                                 rays[i].x + at * rays[i].step_x);
        const float coverage = std::clamp(seen.coverage, 0.0F, 1.0F);
        light += through * coverage * seen.brightness;
        through *= 1.0F - coverage;
      }
      *out++ = light;
    }
  }
}

}  // namespace

torch::Tensor views_of_reference(const std::vector<Surface>& surfaces, int64_t size) {
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
  if (!surfaces.front().brightness.device().is_cpu()) return views_of_reference(surfaces, size);
  std::vector<torch::Tensor> interleaved;
  std::vector<const float*> maps;
  for (const Surface& surface : surfaces) {
    maps.push_back(interleaved.emplace_back(interleave(surface)).data_ptr<float>());
  }
  auto views = torch::empty({kViewsPerSide * kViewsPerSide, size, size});
  at::parallel_for(0, views.size(0), 1, [&](int64_t begin, int64_t end) {
    for (int64_t view = begin; view < end; ++view) {
      render_view(surfaces, maps, static_cast<double>(view / kViewsPerSide) - kCentralView,
                  static_cast<double>(view % kViewsPerSide) - kCentralView, size,
                  views.data_ptr<float>() + view * size * size);
    }
  });
  return views;
}

}  // namespace e2lf::learn
