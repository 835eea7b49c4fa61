// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/compare/tables.h"

namespace e2lf::compare {
namespace {

TEST(Look, KeepsColourAndShowsNoErrorWhereThereIsNone) {
  lightfield::LightField field({2, 2, 30, 40, 3});
  for (size_t i = 0; i < field.data().size(); ++i) field.data()[i] = static_cast<float>(i % 3) / 4.0F;
  lightfield::LightField other = field;
  other.at(0, 0, 7, 5, 1) += 0.15F;  // three times this is the mean over the channels that is white
  const lightfield::Image same = look(field, &field), off = look(other, &field);
  ASSERT_EQ(same.channels, 3U);
  ASSERT_EQ(same.width, 2 * 40U + 4);
  const auto at = [](const lightfield::Image& image, size_t y, size_t x) {
    return image.pixels.data() + (y * image.width + x) * 3;
  };
  for (size_t channel = 0; channel < 3; ++channel) {
    EXPECT_FLOAT_EQ(at(same, 3, 2)[channel], static_cast<float>(channel) / 4.0F);
    EXPECT_FLOAT_EQ(at(same, 7, 44 + 5)[channel], 0.0F);
    EXPECT_NEAR(at(off, 7, 44 + 5)[channel], 0.25, 1e-5);
  }
}

}  // namespace
}  // namespace e2lf::compare
