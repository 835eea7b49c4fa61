// SPDX-License-Identifier: MIT
#include "e2lf/film/parallax.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "e2lf/lightfield/refocus.h"

namespace e2lf::film {
namespace {

using lightfield::Image;
using lightfield::LightField;
using lightfield::Shape;

float angle_of(size_t frame, size_t frames) {
  return 2 * std::numbers::pi_v<float> * static_cast<float>(frame) / static_cast<float>(frames);
}

/// The two views around a position along one axis, and the weight of the second one.
struct Between {
  size_t first = 0;
  float share = 0;
};

Between between(float place, size_t views) {
  E2LF_REQUIRE(place >= -0.001F && place <= static_cast<float>(views - 1) + 0.001F, "a viewpoint among the views");
  const float inside = std::clamp(place, 0.0F, static_cast<float>(views - 1));
  const size_t first = std::min(static_cast<size_t>(inside), views < 2 ? 0 : views - 2);
  return {first, inside - static_cast<float>(first)};
}

}  // namespace

std::vector<Viewpoint> orbit(const Shape& shape, size_t frames) {
  const float middle_y = 0.5F * static_cast<float>(shape.views_y - 1);
  const float middle_x = 0.5F * static_cast<float>(shape.views_x - 1);
  std::vector<Viewpoint> path(frames);
  for (size_t i = 0; i < frames; ++i) {
    const float angle = angle_of(i, frames);
    path[i] = {middle_y - middle_y * std::cos(angle), middle_x + middle_x * std::sin(angle)};
  }
  return path;
}

std::vector<Viewpoint> sweep(const Shape& shape, size_t frames) {
  const float middle_y = 0.5F * static_cast<float>(shape.views_y - 1);
  const float middle_x = 0.5F * static_cast<float>(shape.views_x - 1);
  std::vector<Viewpoint> path(frames);
  for (size_t i = 0; i < frames; ++i) path[i] = {middle_y, middle_x - middle_x * std::cos(angle_of(i, frames))};
  return path;
}

std::vector<float> focus_sweep(float first, float last, size_t frames) {
  std::vector<float> path(frames);
  for (size_t i = 0; i < frames; ++i) {
    path[i] = first + (last - first) * 0.5F * (1 - std::cos(angle_of(i, frames)));
  }
  return path;
}

Image picture_from(const LightField& light_field, const Viewpoint& viewpoint, float still_px) {
  const Shape& shape = light_field.shape();
  lightfield::Aperture aperture{shape.views_y, shape.views_x, std::vector<float>(shape.num_views())};
  const Between y = between(viewpoint.y, shape.views_y), x = between(viewpoint.x, shape.views_x);
  for (size_t j = 0; j < std::min<size_t>(2, shape.views_y); ++j) {
    for (size_t i = 0; i < std::min<size_t>(2, shape.views_x); ++i) {
      const float share_y = j == 0 ? 1 - y.share : y.share, share_x = i == 0 ? 1 - x.share : x.share;
      aperture.weights[(y.first + j) * shape.views_x + x.first + i] = share_y * share_x;
    }
  }
  return lightfield::refocus(light_field, still_px, aperture);
}

}  // namespace e2lf::film
