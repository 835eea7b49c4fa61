// SPDX-License-Identifier: MIT
#include "e2lf/sensor/coded_intensity.h"

#include <algorithm>

#include "e2lf/base/contract.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/sensor/block_kernels.h"

namespace e2lf::sensor {

Result<void> check_fit(const capture::Codes& codes, const lightfield::LightField& light_field) {
  const lightfield::Shape& shape = light_field.shape();
  if (shape.channels != 1) {
    return Error{ErrorCode::kShape, cat("the light field has ", shape.channels, " channels; turn it to grey first"),
                 ""};
  }
  if (codes.views_y != shape.views_y || codes.views_x != shape.views_x) {
    return Error{ErrorCode::kShape,
                 cat("the codes are for ", codes.views_y, "x", codes.views_x, " views, the light field has ",
                     shape.views_y, "x", shape.views_x, "; use codes and light field of one camera"),
                 ""};
  }
  return {};
}

void code_block(const capture::Codes& codes, const lightfield::LightField& light_field, size_t first, size_t count,
                float* sums, size_t stride) {
  const lightfield::Shape& shape = light_field.shape();
  for (size_t n = 0; n < codes.num_patterns; ++n) std::fill_n(sums + n * stride, count, 0.0F);
  for (size_t view = 0; view < shape.num_views(); ++view) {
    const float* values = light_field.data().data() + view * shape.view_size() + first;
    for (size_t n = 0; n < codes.num_patterns; ++n) {
      const float weight = codes.pattern(n)[view] / static_cast<float>(shape.num_views());
      // Learned patterns are mostly closed, so that views blocked by all patterns are never read.
      if (weight != 0) add_scaled(values, weight, sums + n * stride, count);
    }
  }
}

Result<CodedIntensities> coded_intensities(const capture::Codes& codes, const lightfield::LightField& light_field) {
  E2LF_RETURN_IF_ERROR(check_fit(codes, light_field));
  const lightfield::Shape& shape = light_field.shape();
  CodedIntensities intensities(codes.num_patterns, shape.height, shape.width);
  const size_t num_pixels = intensities.image_size();
  for_block_ranges(num_pixels, [&](size_t begin, size_t end) {
    for (size_t block = begin; block < end; ++block) {
      const size_t first = block * kBlockPixels;
      code_block(codes, light_field, first, std::min(kBlockPixels, num_pixels - first),
                 intensities.values.data() + first, num_pixels);
    }
  });
  return intensities;
}

lightfield::LightField light_behind(const capture::ColourFilter& filter, const lightfield::LightField& colour) {
  const lightfield::Shape& shape = colour.shape();
  E2LF_REQUIRE(shape.channels == 3, "colour filters need colour");
  lightfield::LightField light({shape.views_y, shape.views_x, 2 * shape.height, 2 * shape.width});
  parallel_for(shape.num_views(), 1, [&](size_t begin, size_t end) {
    for (size_t view = begin; view < end; ++view) {
      const auto from = colour.view(view / shape.views_x, view % shape.views_x);
      const auto to = light.view(view / shape.views_x, view % shape.views_x);
      for (size_t y = 0; y < 2 * shape.height; ++y) {
        for (size_t x = 0; x < 2 * shape.width; ++x) {
          const size_t channel = filter.channels[2 * (y % 2) + x % 2];
          to[y * 2 * shape.width + x] = from[(y / 2 * shape.width + x / 2) * 3 + channel];
        }
      }
    }
  });
  return light;
}

}  // namespace e2lf::sensor
