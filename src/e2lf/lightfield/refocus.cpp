// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/refocus.h"

#include <numeric>

#include "e2lf/base/threads.h"

namespace e2lf::lightfield {
namespace {

/// A view with its weight and shifts.
struct ShiftedView {
  StridedView<const float, 3> pixels;
  float weight = 0;
  ShiftFilter vertical, horizontal;
};

std::vector<ShiftedView> shifted_views(const LightFieldView& light_field, float disparity, const Aperture& aperture) {
  const Shape shape = shape_of(light_field);
  const float light = std::accumulate(aperture.weights.begin(), aperture.weights.end(), 0.0F);
  E2LF_REQUIRE(light > 0, "the aperture lets no light through");
  const float middle_y = static_cast<float>(shape.views_y - 1) / 2,
              middle_x = static_cast<float>(shape.views_x - 1) / 2;
  std::vector<ShiftedView> views;
  for (size_t view_y = 0; view_y < shape.views_y; ++view_y) {
    for (size_t view_x = 0; view_x < shape.views_x; ++view_x) {
      const float weight = aperture.weights[view_y * shape.views_x + view_x];
      E2LF_REQUIRE(weight >= 0, "weights of an aperture cannot be negative");
      if (weight == 0) continue;
      views.push_back({light_field[view_y][view_x], weight / light,
                       make_shift_filter(disparity * (static_cast<float>(view_y) - middle_y)),
                       make_shift_filter(disparity * (static_cast<float>(view_x) - middle_x))});
    }
  }
  return views;
}

struct Scratch {
  std::vector<float> padded, row;
};

/// Adds the shifted view to one output row. `padded` is the vertically filtered row, extended by
/// copies of its first and last pixel, so that the horizontal filter needs no bounds checks.
void add_row(const ShiftedView& view, const Shape& shape, size_t y, Scratch& scratch, float* out) {
  std::vector<float>& padded = scratch.padded;
  const size_t row_size = shape.width * shape.channels;
  const auto width = static_cast<ptrdiff_t>(shape.width), last_row = static_cast<ptrdiff_t>(shape.height) - 1;
  const ptrdiff_t first = std::clamp<ptrdiff_t>(view.horizontal.first, -width - kShiftTaps, width);
  const auto pad_left = static_cast<size_t>(std::max<ptrdiff_t>(0, -first));
  const auto pad_right = static_cast<size_t>(std::max<ptrdiff_t>(0, first + kShiftTaps - 1));
  padded.assign((pad_left + shape.width + pad_right) * shape.channels, 0.0F);

  float* middle = padded.data() + pad_left * shape.channels;
  for (int k = 0; k < kShiftTaps; ++k) {
    const float tap = view.weight * view.vertical.taps[k];
    if (tap == 0) continue;
    const ptrdiff_t row = std::clamp<ptrdiff_t>(static_cast<ptrdiff_t>(y) + view.vertical.first + k, 0, last_row);
    const auto source = view.pixels[static_cast<size_t>(row)].values(scratch.row);
    for (size_t i = 0; i < row_size; ++i) middle[i] += tap * source[i];
  }
  for (size_t i = 0; i < pad_left * shape.channels; ++i) padded[i] = middle[i % shape.channels];
  for (size_t i = 0; i < pad_right * shape.channels; ++i) {
    middle[row_size + i] = middle[row_size - shape.channels + i % shape.channels];
  }

  const float* shifted = middle + first * static_cast<ptrdiff_t>(shape.channels);
  const size_t step = shape.channels;
  const auto& taps = view.horizontal.taps;
  for (size_t i = 0; i < row_size; ++i) {
    out[i] += taps[0] * shifted[i] + taps[1] * shifted[i + step] + taps[2] * shifted[i + 2 * step] +
              taps[3] * shifted[i + 3 * step];
  }
}

}  // namespace

Aperture full_aperture(const Shape& shape) {
  return {shape.views_y, shape.views_x, std::vector<float>(shape.num_views(), 1.0F)};
}

Aperture round_aperture(const Shape& shape, const RoundAperture& disc) {
  Aperture aperture{shape.views_y, shape.views_x, {}};
  for (size_t view_y = 0; view_y < shape.views_y; ++view_y) {
    for (size_t view_x = 0; view_x < shape.views_x; ++view_x) {
      const float dy = static_cast<float>(view_y) - static_cast<float>(shape.views_y - 1) / 2 - disc.centre_y;
      const float dx = static_cast<float>(view_x) - static_cast<float>(shape.views_x - 1) / 2 - disc.centre_x;
      aperture.weights.push_back(std::clamp(disc.radius + 0.5F - std::hypot(dy, dx), 0.0F, 1.0F));
    }
  }
  return aperture;
}

Image refocus(const LightFieldView& light_field, float disparity, const Aperture& aperture) {
  const Shape shape = shape_of(light_field);
  E2LF_REQUIRE(shape.size() > 0, "a light field needs pixels to be refocused");
  E2LF_REQUIRE(aperture.views_y == shape.views_y && aperture.views_x == shape.views_x &&
                   aperture.weights.size() == shape.num_views(),
               "the aperture must have one weight for each view");
  E2LF_REQUIRE(std::isfinite(disparity), "the disparity must be finite");
  const auto views = shifted_views(light_field, disparity, aperture);
  Image image(shape.width, shape.height, shape.channels);
  parallel_for(shape.height, 8, [&](size_t begin, size_t end) {
    Scratch scratch;
    // The loop over views is outside of that over rows because the rows of one view are contiguous in memory.
    for (const ShiftedView& view : views) {
      for (size_t y = begin; y < end; ++y) {
        add_row(view, shape, y, scratch, image.pixels.data() + y * shape.width * shape.channels);
      }
    }
  });
  return image;
}

}  // namespace e2lf::lightfield
