// SPDX-License-Identifier: MIT
#include "e2lf/sensor/colour_filter_light.h"

#include <gtest/gtest.h>

namespace e2lf::sensor {
namespace {

TEST(LightBehind, EachPixelOfABlockSeesTheChannelOfItsFilter) {
  lightfield::LightField colour({2, 1, 3, 2, 3});
  for (size_t i = 0; i < colour.data().size(); ++i) colour.data()[i] = static_cast<float>(i);
  const capture::ColourFilter filter = capture::colour_filter_from_name("gbrg").value();
  const lightfield::LightField light = light_behind(filter, colour);
  EXPECT_EQ(light.shape(), (lightfield::Shape{2, 1, 6, 4, 1}));
  for (size_t view = 0; view < 2; ++view) {
    for (size_t y = 0; y < 6; ++y) {
      for (size_t x = 0; x < 4; ++x) {
        const size_t channel = filter.channels[2 * (y % 2) + x % 2];
        EXPECT_EQ(light.at(view, 0, y, x), colour.at(view, 0, y / 2, x / 2, channel)) << view << y << x;
      }
    }
  }
}

}  // namespace
}  // namespace e2lf::sensor
