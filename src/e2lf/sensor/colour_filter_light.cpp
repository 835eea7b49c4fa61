// SPDX-License-Identifier: MIT
#include "e2lf/sensor/colour_filter_light.h"

#include "e2lf/base/contract.h"
#include "e2lf/base/threads.h"

namespace e2lf::sensor {

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
