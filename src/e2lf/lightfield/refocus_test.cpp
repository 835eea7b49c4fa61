// SPDX-License-Identifier: MIT
#include "e2lf/lightfield/refocus.h"

#include <gtest/gtest.h>
#include <numeric>

#include "e2lf/base/rng.h"
#include "e2lf/base/threads.h"
#include "e2lf/lightfield/scene.h"
#include "testing/textured_plane.h"

namespace e2lf::lightfield {
namespace {

/// Root mean square of the difference, `margin` px from the borders.
double inner_rms(const Image& a, const Image& b, size_t margin) {
  double sum = 0, count = 0;
  for (size_t y = margin; y + margin < a.height; ++y) {
    for (size_t x = margin; x + margin < a.width; ++x, ++count) {
      const double difference = a.pixels[y * a.width + x] - b.pixels[y * a.width + x];
      sum += difference * difference;
    }
  }
  return std::sqrt(sum / count);
}

double deviation(const Image& image) {
  Image mean = image;
  const auto count = static_cast<float>(image.pixels.size());
  const float value = std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0F) / count;
  std::fill(mean.pixels.begin(), mean.pixels.end(), value);
  return inner_rms(image, mean, 0);
}

LightField noise_light_field(const Shape& shape) {
  LightField light_field(shape);
  const CounterRng rng(5, 0);
  for (size_t i = 0; i < shape.size(); ++i) light_field.data()[i] = rng.uniform(i);
  return light_field;
}

TEST(Refocus, AtThePlanesDisparityIsTheMiddleView) {
  for (float disparity : {-1.5F, 0.0F, 0.7F, 2.0F}) {
    const ProceduralScene scene = textured_plane_scene(disparity);
    const LightField light_field = render_light_field(scene, {8, 8, 48, 64, 1});
    const Image middle = render_view(scene, {48, 64, 0, 0});
    const Image sharp = refocus(light_field, disparity, full_aperture(light_field.shape()));
    EXPECT_LT(inner_rms(sharp, middle, 10), 0.05 * deviation(middle)) << disparity;
    const Image blurred = refocus(light_field, disparity + 1, full_aperture(light_field.shape()));
    EXPECT_GT(inner_rms(blurred, middle, 10), 0.3 * deviation(middle)) << disparity;
    EXPECT_LT(deviation(blurred), 0.9 * deviation(sharp)) << disparity;
  }
}

TEST(Refocus, AtZeroIsTheWeightedMeanOfTheViews) {
  const LightField light_field = noise_light_field({2, 2, 9, 13, 3});
  const Image image = refocus(light_field, 0, {2, 2, {1, 0, 2, 5}});
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    const float expected =
        (light_field.view(0, 0)[i] + 2 * light_field.view(1, 0)[i] + 5 * light_field.view(1, 1)[i]) / 8;
    ASSERT_NEAR(image.pixels[i], expected, 1e-6);
  }
}

TEST(Refocus, ShiftsWholePixelsExactlyAndRepeatsTheBorder) {
  const LightField light_field = noise_light_field({3, 3, 9, 13, 3});
  Aperture corner{3, 3, std::vector<float>(9)};
  corner.weights[2] = 0.5F;  // view (0, 2): one step up, one to the right of the middle
  const Image image = refocus(light_field, 2, corner);
  for (size_t y = 0; y < 9; ++y) {
    for (size_t x = 0; x < 13; ++x) {
      const size_t from_y = y < 2 ? 0 : y - 2, from_x = std::min<size_t>(x + 2, 12);
      for (size_t c = 0; c < 3; ++c) {
        ASSERT_EQ(image.pixels[(y * 13 + x) * 3 + c], light_field.at(0, 2, from_y, from_x, c)) << y << ' ' << x;
      }
    }
  }
}

TEST(Refocus, InterpolatesARampWithoutError) {
  LightField light_field({1, 2, 4, 40, 1});
  for (size_t view_x = 0; view_x < 2; ++view_x) {
    for (size_t i = 0; i < 160; ++i) light_field.view(0, view_x)[i] = static_cast<float>(i % 40);
  }
  const Image image = refocus(light_field, 0.6F, {1, 2, {0, 1}});  // view 1 is half a step right of the middle
  for (size_t x = 2; x < 37; ++x) EXPECT_NEAR(image.pixels[40 + x], static_cast<float>(x) + 0.3F, 1e-4);
}

TEST(Refocus, SurvivesShiftsLargerThanTheView) {
  LightField light_field({1, 2, 5, 6, 1});
  for (float& value : light_field.data()) value = 0.25F;
  for (float disparity : {-1e30F, -30.0F, 30.0F, 1e30F}) {
    for (float value : refocus(light_field, disparity, full_aperture(light_field.shape())).pixels) {
      ASSERT_NEAR(value, 0.25F, 1e-6);
    }
  }
}

TEST(Refocus, DoesNotDependOnTheNumberOfThreads) {
  const LightField light_field = noise_light_field({4, 4, 50, 33, 1});
  set_num_threads(1);
  const Image one = refocus(light_field, 0.3F, full_aperture(light_field.shape()));
  set_num_threads(3);
  const Image three = refocus(light_field, 0.3F, full_aperture(light_field.shape()));
  set_num_threads(0);
  EXPECT_EQ(one, three);
}

TEST(Refocus, RefusesAnApertureThatDoesNotFit) {
  const LightField light_field({2, 2, 4, 4, 1});
  EXPECT_THROW((void)refocus(light_field, 0, {2, 3, std::vector<float>(6, 1.0F)}), ContractError);
  EXPECT_THROW((void)refocus(light_field, 0, {2, 2, {0, 0, 0, 0}}), ContractError);
  EXPECT_THROW((void)refocus(light_field, 0, {2, 2, {1, -1, 1, 1}}), ContractError);
}

TEST(RoundAperture, FadesOverOneViewStep) {
  const Shape shape{5, 5, 1, 1, 1};
  const Aperture pinhole = round_aperture(shape, {.radius = 0.5F});
  EXPECT_EQ(std::accumulate(pinhole.weights.begin(), pinhole.weights.end(), 0.0F), 1.0F);
  EXPECT_EQ(pinhole.weights[2 * 5 + 2], 1.0F);
  const Aperture disc = round_aperture(shape, {.radius = 1.0F, .centre_y = 0, .centre_x = 1});
  EXPECT_EQ(disc.weights[2 * 5 + 3], 1.0F);
  EXPECT_EQ(disc.weights[2 * 5 + 2], 0.5F);
  EXPECT_EQ(disc.weights[2 * 5 + 1], 0.0F);
  EXPECT_EQ(round_aperture(shape, {.radius = 10}).weights, full_aperture(shape).weights);
}

}  // namespace
}  // namespace e2lf::lightfield
