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

/// Limits the range of a number from the browser; NaN becomes 0.
float limited(float value, float most) {
  return std::isnan(value) ? 0.0F : std::clamp(value, -most, most);
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

Picture render(const LiveField& field, const Look& look) {
  constexpr float kMostDisparity = 32;
  const lightfield::Shape& shape = field.light_field.shape();
  const float scale = field.size == PictureSize::kHalf ? 0.5F : 1.0F;
  Picture picture;
  picture.image = toned(
      lightfield::refocus(field.light_field, scale * limited(look.focus, kMostDisparity), aperture_of(shape, look)),
      field);
  const auto nearest = [](float offset, size_t count) {
    const float place = limited(offset, static_cast<float>(count)) + static_cast<float>(count - 1) / 2;
    return static_cast<size_t>(std::clamp(std::round(place), 0.0F, static_cast<float>(count - 1)));
  };
  const auto cut = [scale](uint32_t px, size_t count) {
    return std::min(static_cast<size_t>(scale * static_cast<float>(px)), count - 1);
  };
  if (look.row) {
    picture.row_epi = toned(
        lightfield::horizontal_epi(field.light_field, nearest(look.y, shape.views_y), cut(*look.row, shape.height)),
        field);
  }
  if (look.column) {
    picture.column_epi = toned(
        lightfield::vertical_epi(field.light_field, nearest(look.x, shape.views_x), cut(*look.column, shape.width)),
        field);
  }
  return picture;
}

}  // namespace e2lf::live
