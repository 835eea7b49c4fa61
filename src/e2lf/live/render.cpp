// SPDX-License-Identifier: MIT
#include "e2lf/live/render.h"

#include <algorithm>
#include <cmath>

#include "e2lf/lightfield/views.h"

namespace e2lf::live {
namespace {

float tent(float offset) {
  return std::max(0.0F, 1.0F - std::abs(offset));
}

/// Limits the range of a number from the browser; NaN becomes 0.
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

float scale_of(const LiveField& field) {
  return 1.0F / static_cast<float>(block_side(field.level.size));
}

/// Returns the value at a position between four pixels; outside of the view, that of its border.
float sample(std::span<const float> view, const lightfield::Shape& shape, float x, float y) {
  x = std::clamp(x, 0.0F, static_cast<float>(shape.width - 1));
  y = std::clamp(y, 0.0F, static_cast<float>(shape.height - 1));
  const auto left = static_cast<size_t>(x), top = static_cast<size_t>(y);
  const size_t right = std::min(left + 1, shape.width - 1), bottom = std::min(top + 1, shape.height - 1);
  const auto value = [&](size_t row, size_t column) { return view[(row * shape.width + column) * shape.channels]; };
  const float share_x = x - static_cast<float>(left), share_y = y - static_cast<float>(top);
  return std::lerp(std::lerp(value(top, left), value(top, right), share_x),
                   std::lerp(value(bottom, left), value(bottom, right), share_x), share_y);
}

/// Returns the variance of the views, summed over a window around a point of the central view.
double disagreement(const lightfield::LightField& light_field, float x, float y, float disparity) {
  constexpr int kReach = 4;
  const lightfield::Shape& shape = light_field.shape();
  const float middle_y = static_cast<float>(shape.views_y - 1) / 2,
              middle_x = static_cast<float>(shape.views_x - 1) / 2;
  const auto count = static_cast<double>(shape.num_views());
  double total = 0;
  for (int dy = -kReach; dy <= kReach; ++dy) {
    for (int dx = -kReach; dx <= kReach; ++dx) {
      double sum = 0, squares = 0;
      for (size_t view = 0; view < shape.num_views(); ++view) {
        const size_t row = view / shape.views_x, column = view % shape.views_x;
        const double value = sample(light_field.view(row, column), shape,
                                    x + static_cast<float>(dx) + disparity * (static_cast<float>(column) - middle_x),
                                    y + static_cast<float>(dy) + disparity * (static_cast<float>(row) - middle_y));
        sum += value;
        squares += value * value;
      }
      total += squares / count - sum / count * (sum / count);
    }
  }
  return total;
}

/// Returns the weight of each view. For a radius of at least one view step, the weights are those of
/// lightfield::round_aperture(); for smaller radii, they blend into the interpolation of the viewpoint from its
/// neighbouring views.
lightfield::Aperture aperture_of(const lightfield::Shape& shape, const RenderSettings& settings) {
  const float middle_y = static_cast<float>(shape.views_y - 1) / 2,
              middle_x = static_cast<float>(shape.views_x - 1) / 2;
  const float x = limited(settings.x, middle_x), y = limited(settings.y, middle_y);
  const float radius = std::max(0.0F, limited(settings.radius, middle_x + middle_y));
  lightfield::Aperture aperture = lightfield::round_aperture(shape, {.radius = radius, .centre_y = y, .centre_x = x});
  const float share = std::min(1.0F, radius);
  for (size_t view = 0; view < aperture.weights.size(); ++view) {
    const float dy = static_cast<float>(view / shape.views_x) - middle_y - y;
    const float dx = static_cast<float>(view % shape.views_x) - middle_x - x;
    aperture.weights[view] = share * aperture.weights[view] + (1 - share) * tent(dx) * tent(dy);
  }
  return aperture;
}

}  // namespace

std::vector<size_t> views_of(const lightfield::Shape& shape, const RenderSettings& settings) {
  const lightfield::Aperture aperture = aperture_of(shape, settings);
  const size_t row = nearest_view(settings.y, shape.views_y), column = nearest_view(settings.x, shape.views_x);
  std::vector<size_t> views;
  for (size_t view = 0; view < shape.num_views(); ++view) {
    const bool is_cut =
        (settings.row && view / shape.views_x == row) || (settings.column && view % shape.views_x == column);
    if (is_cut || aperture.weights[view] > 0) views.push_back(view);
  }
  return views.size() == shape.num_views() ? std::vector<size_t>() : views;
}

bool has_views(const LiveField& field, const std::vector<size_t>& views) {
  return field.views.empty() || (!views.empty() && std::ranges::includes(field.views, views));
}

Picture render(const LiveField& field, const RenderSettings& settings) {
  constexpr float kMostDisparity = 32;
  const lightfield::Shape& shape = field.light_field.shape();
  const float scale = scale_of(field);
  Picture picture;
  picture.image = toned(lightfield::refocus(field.light_field, scale * limited(settings.focus, kMostDisparity),
                                            aperture_of(shape, settings)),
                        field);
  const auto cut = [scale](uint32_t px, size_t count) {
    return std::min(static_cast<size_t>(scale * static_cast<float>(px)), count - 1);
  };
  if (settings.row) {
    picture.row_epi = toned(lightfield::horizontal_epi(field.light_field, nearest_view(settings.y, shape.views_y),
                                                       cut(*settings.row, shape.height)),
                            field);
  }
  if (settings.column) {
    picture.column_epi = toned(lightfield::vertical_epi(field.light_field, nearest_view(settings.x, shape.views_x),
                                                        cut(*settings.column, shape.width)),
                               field);
  }
  return picture;
}

float disparity_at(const LiveField& field, float x, float y) {
  constexpr int kSteps = 100;  // in each direction
  constexpr float kMostDisparity = 5, kStep = kMostDisparity / kSteps;
  const lightfield::Shape& shape = field.light_field.shape();
  const float scale = scale_of(field);
  const float column = limited(scale * x, static_cast<float>(shape.width)),
              row = limited(scale * y, static_cast<float>(shape.height));
  std::vector<double> costs;
  for (int step = -kSteps; step <= kSteps; ++step) {
    costs.push_back(disagreement(field.light_field, column, row, scale * kStep * static_cast<float>(step)));
  }
  const auto best = std::min_element(costs.begin(), costs.end());
  double place = static_cast<double>(best - costs.begin());
  // The minimum between two steps is that of a parabola.
  if (best != costs.begin() && best + 1 != costs.end()) {
    const double bend = *(best - 1) - 2 * *best + *(best + 1);
    if (bend > 0) place += 0.5 * (*(best - 1) - *(best + 1)) / bend;
  }
  return kStep * static_cast<float>(place - kSteps);
}

lightfield::LightField enlarged(const lightfield::LightField& light_field, size_t height, size_t width) {
  const lightfield::Shape& small = light_field.shape();
  E2LF_REQUIRE(small.height > 0 && small.width > 0 && small.channels == 1, "a grey light field with pixels");
  const size_t side = std::max<size_t>(1, std::min(height / small.height, width / small.width));
  lightfield::LightField result({small.views_y, small.views_x, height, width, 1});
  for (size_t view = 0; view < small.num_views(); ++view) {
    const size_t row = view / small.views_x, column = view % small.views_x;
    const std::span<const float> from = light_field.view(row, column);
    const std::span<float> to = result.view(row, column);
    for (size_t y = 0; y < height; ++y) {
      const size_t from_y = std::min(y / side, small.height - 1);
      for (size_t x = 0; x < width; ++x) {
        to[y * width + x] = from[from_y * small.width + std::min(x / side, small.width - 1)];
      }
    }
  }
  return result;
}

}  // namespace e2lf::live
