// SPDX-License-Identifier: MIT
#include "e2lf/film/draw_svg.h"

#include <gtest/gtest.h>

#include "e2lf/film/film_file.h"

namespace e2lf::film {
namespace {

constexpr const char* kDrawing =
    "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"20\" height=\"10\" viewBox=\"0 0 20 10\">"
    "<rect width=\"100%\" height=\"100%\" fill=\"white\"/><rect width=\"10\" height=\"5\" fill=\"#ff8000\"/></svg>";

TEST(DrawSvg, HasTheColoursOfTheDrawingAtTheSizeAskedFor) {
  if (!check_film_support()) GTEST_SKIP() << "a build without FFmpeg's libraries";
  const auto image = draw_svg(kDrawing, 80);
  ASSERT_TRUE(image) << image.error().text();
  ASSERT_EQ(image->width, 80U);
  ASSERT_EQ(image->height, 40U);
  ASSERT_EQ(image->channels, 3U);
  const auto at = [&](size_t x, size_t y) { return image->pixels.data() + (y * 80 + x) * 3; };
  EXPECT_FLOAT_EQ(at(10, 10)[0], 1.0F);
  EXPECT_FLOAT_EQ(at(10, 10)[1], 128.0F / 255.0F);
  EXPECT_FLOAT_EQ(at(10, 10)[2], 0.0F);
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_FLOAT_EQ(at(60, 10)[channel], 1.0F);
    EXPECT_FLOAT_EQ(at(10, 30)[channel], 1.0F);
  }
}

TEST(DrawSvg, SaysWhatIsNoDrawing) {
  if (!check_film_support()) GTEST_SKIP() << "a build without FFmpeg's libraries";
  const auto image = draw_svg("no drawing", 80);
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().code, ErrorCode::kFormat);
}

}  // namespace
}  // namespace e2lf::film
