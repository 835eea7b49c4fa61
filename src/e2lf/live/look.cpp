// SPDX-License-Identifier: MIT
#include "e2lf/live/look.h"

#include <algorithm>
#include <cmath>

#include "e2lf/lightfield/epi.h"

namespace e2lf::live {
namespace {

float tent(float offset) {
  return std::max(0.0F, 1.0F - std::abs(offset));
}

/// Limits a number that came from a browser; NaN becomes 0.
float limited(float value, float most) {
  return std::isnan(value) ? 0.0F : std::clamp(value, -most, most);
}

/// Returns the number of the view of a row or column that is nearest to an offset from the middle.
size_t nearest_view(float offset, size_t count) {
  const float place = limited(offset, static_cast<float>(count)) + static_cast<float>(count - 1) / 2;
  return static_cast<size_t>(std::clamp(std::round(place), 0.0F, static_cast<float>(count - 1)));
}

lightfield::ByteImage toned(lightfield::Image image, const LiveField& field) {
  for (float& value : image.pixels) value = field.gain * (value - field.black);
  return lightfield::to_bytes(image);
}

}  // namespace

lightfield::Aperture aperture_of(const lightfield::Shape& shape, const Look& look) {
  const float middle_y = static_cast<float>(shape.views_y - 1) / 2,
              middle_x = static_cast<float>(shape.views_x - 1) / 2;
  const float x = limited(look.x, middle_x), y = limited(look.y, middle_y);
  const float radius = std::max(0.0F, limited(look.radius, middle_x + middle_y));
  lightfield::Aperture aperture = lightfield::round_aperture(shape, {.radius = radius, .centre_y = y, .centre_x = x});
  const float share = std::min(1.0F, radius);
  for (size_t view = 0; view < aperture.weights.size(); ++view) {
    const float dy = static_cast<float>(view / shape.views_x) - middle_y - y;
    const float dx = static_cast<float>(view % shape.views_x) - middle_x - x;
    aperture.weights[view] = share * aperture.weights[view] + (1 - share) * tent(dx) * tent(dy);
  }
  return aperture;
}

std::vector<size_t> views_of(const lightfield::Shape& shape, const Look& look) {
  const lightfield::Aperture aperture = aperture_of(shape, look);
  const size_t row = nearest_view(look.y, shape.views_y), column = nearest_view(look.x, shape.views_x);
  std::vector<size_t> views;
  for (size_t view = 0; view < shape.num_views(); ++view) {
    const bool is_cut = (look.row && view / shape.views_x == row) || (look.column && view % shape.views_x == column);
    if (is_cut || aperture.weights[view] > 0) views.push_back(view);
  }
  return views.size() == shape.num_views() ? std::vector<size_t>() : views;
}

bool has_views(const LiveField& field, const std::vector<size_t>& views) {
  return field.views.empty() || (!views.empty() && std::ranges::includes(field.views, views));
}

Picture render(const LiveField& field, const Look& look) {
  constexpr float kMostDisparity = 32;
  const lightfield::Shape& shape = field.light_field.shape();
  const float scale = 1.0F / static_cast<float>(block_side(field.gait.size));
  Picture picture;
  picture.image = toned(
      lightfield::refocus(field.light_field, scale * limited(look.focus, kMostDisparity), aperture_of(shape, look)),
      field);
  const auto cut = [scale](uint32_t px, size_t count) {
    return std::min(static_cast<size_t>(scale * static_cast<float>(px)), count - 1);
  };
  if (look.row) {
    picture.row_epi = toned(lightfield::horizontal_epi(field.light_field, nearest_view(look.y, shape.views_y),
                                                       cut(*look.row, shape.height)),
                            field);
  }
  if (look.column) {
    picture.column_epi = toned(lightfield::vertical_epi(field.light_field, nearest_view(look.x, shape.views_x),
                                                        cut(*look.column, shape.width)),
                               field);
  }
  return picture;
}

}  // namespace e2lf::live
