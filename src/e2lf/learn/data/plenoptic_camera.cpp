// SPDX-License-Identifier: MIT
#include "e2lf/learn/data/plenoptic_camera.h"

#include <algorithm>
#include <cmath>

#include "e2lf/learn/data/dataset.h"

namespace e2lf::learn {
namespace {

constexpr double kDetailPx = 4.0;  // finer structures lose contrast in the corner views

/// Returns the squared distance of the points of a grid from its centre, relative to that of its corners.
torch::Tensor squared_radius(int64_t height, int64_t width, torch::Device device) {
  const auto axis = [&](int64_t length) {
    return torch::linspace(-1.0, 1.0, length, torch::device(device).dtype(torch::kFloat)).square();
  };
  return 0.5 * (axis(height).unsqueeze(1) + axis(width).unsqueeze(0));
}

torch::Tensor gaussian(double sigma_px, torch::Device device) {
  const auto reach = static_cast<double>(std::ceil(3.0 * sigma_px));
  const auto place = torch::arange(-reach, reach + 1.0, torch::device(device).dtype(torch::kFloat));
  const auto weights = torch::exp(-0.5 * (place / std::max(sigma_px, 1e-3)).square());
  return weights / weights.sum();
}

/// Blurs each view; its border values are repeated.
torch::Tensor blurred(const torch::Tensor& views, double sigma_y_px, double sigma_x_px) {
  const auto down = gaussian(sigma_y_px, views.device()), across = gaussian(sigma_x_px, views.device());
  const int64_t reach_y = down.size(0) / 2, reach_x = across.size(0) / 2;
  const auto padded = at::replication_pad2d(views.unsqueeze(1), {reach_x, reach_x, reach_y, reach_y});
  return at::conv2d(at::conv2d(padded, down.reshape({1, 1, -1, 1})), across.reshape({1, 1, 1, -1})).squeeze(1);
}

}  // namespace

torch::Tensor PlenopticCamera::show(const torch::Tensor& views) const {
  auto shown = views.clamp(0.0, 1.0).pow(gamma);
  if (corner_contrast < 1.0) {
    const auto loss = (1.0 - corner_contrast) * squared_radius(kViewsPerSide, kViewsPerSide, views.device());
    shown = torch::lerp(shown, blurred(shown, kDetailPx, kDetailPx), loss.reshape({-1, 1, 1}));
  }
  if (blur_y_px > 0.0 || blur_x_px > 0.0) shown = blurred(shown, blur_y_px, blur_x_px);
  if (corner_brightness < 1.0) {
    shown = shown * (1.0 - (1.0 - corner_brightness) * squared_radius(views.size(1), views.size(2), views.device()));
  }
  if (grain > 0.0) {
    torch::manual_seed(grain_seed);
    const auto noise = blurred(torch::randn_like(shown), blur_y_px, blur_x_px);
    shown = shown + grain / noise.std() * noise;
  }
  return shown;
}

PlenopticCamera random_plenoptic_camera(Draws& draws) {
  return {.gamma = draws.log_uniform(0.5, 1.0),
          .corner_contrast = draws.uniform(0.87, 1.0),
          .blur_y_px = draws.uniform(0.25, 0.6),
          .blur_x_px = draws.uniform(0.25, 0.75),
          .corner_brightness = draws.uniform(0.75, 1.0),
          .grain = draws.log_uniform(0.004, 0.015),
          .grain_seed = draws.below(uint64_t{1} << 31U)};
}

}  // namespace e2lf::learn
