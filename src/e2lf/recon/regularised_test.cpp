// SPDX-License-Identifier: MIT
#include "e2lf/recon/regularised.h"

#include <algorithm>
#include <gtest/gtest.h>

#include "e2lf/base/threads.h"
#include "e2lf/lightfield/scene.h"
#include "e2lf/recon/linear_estimate.h"
#include "e2lf/sensor/event_model.h"
#include "testing/textured_plane.h"

namespace e2lf::recon {
namespace {

using lightfield::LightField;

const capture::SensorConstants kNoiseFree{.eps = 0.01F, .tau = 0.3F, .sigma_w = 0.0F, .sigma_z = 0.0F};

capture::EventImages events_of(const LightField& scene, const capture::SensorConstants& constants) {
  sensor::EventModelOptions options;
  options.constants = constants;
  options.seed = 3;
  return sensor::simulate_events(capture::default_codes(), scene, options).value();
}

LightField textured_plane(float disparity) {
  return lightfield::render_light_field(lightfield::textured_plane_scene(disparity), {8, 8, 64, 80, 1});
}

double mean_square(const LightField& a, const LightField& b) {
  double sum = 0;
  for (size_t i = 0; i < a.data().size(); ++i) {
    const double difference = double{a.data()[i]} - double{b.data()[i]};
    sum += difference * difference;
  }
  return sum / static_cast<double>(a.data().size());
}

TEST(Regularised, AnEvenSceneStaysEvenAndWithinHalfAThreshold) {
  LightField scene({8, 8, 16, 24, 1});
  std::fill(scene.data().begin(), scene.data().end(), 0.4F);
  const LightField field =
      reconstruct_regularised(events_of(scene, kNoiseFree), capture::default_codes(), kNoiseFree).value();
  const float first = field.data()[0];
  EXPECT_NEAR(first, 0.4F, 0.4F * 0.25F);
  for (const float value : field.data()) ASSERT_NEAR(value, first, 1e-4F);
}

TEST(Regularised, IsBetterThanTheInversionOnANoisyPlane) {
  const LightField scene = textured_plane(1.0F);
  const capture::SensorConstants paper;
  const auto images = events_of(scene, paper);
  const LightField regularised = reconstruct_regularised(images, capture::default_codes(), paper).value();
  const LightField inverted = reconstruct_by_inversion(images, capture::default_codes(), paper).value();
  EXPECT_LT(mean_square(regularised, scene), 0.9 * mean_square(inverted, scene));
}

TEST(Regularised, SmoothnessReducesTheTotalVariation) {
  const auto images = events_of(textured_plane(0.5F), {});
  const auto variation = [&](float smoothness) {
    RegularisedOptions options;
    options.smoothness = smoothness;
    const LightField field = reconstruct_regularised(images, capture::default_codes(), {}, options).value();
    const auto view = field.view(3, 3);
    double sum = 0;
    for (size_t i = 1; i < view.size(); ++i) sum += std::abs(double{view[i]} - double{view[i - 1]});
    return sum;
  };
  const double little = variation(0.5F), more = variation(5.0F), much = variation(20.0F);
  EXPECT_LT(more, 0.9 * little);
  EXPECT_LT(much, 0.9 * more);
}

TEST(Regularised, TheNumberOfThreadsChangesNothing) {
  const auto images = events_of(textured_plane(0.5F), {});
  RegularisedOptions options;
  options.iterations = 5;
  set_num_threads(1);
  const LightField one = reconstruct_regularised(images, capture::default_codes(), {}, options).value();
  set_num_threads(3);
  const LightField three = reconstruct_regularised(images, capture::default_codes(), {}, options).value();
  set_num_threads(0);
  EXPECT_TRUE(std::equal(one.data().begin(), one.data().end(), three.data().begin()));
}

TEST(Regularised, TellsItsProgressToTheEnd) {
  const auto images = events_of(textured_plane(0.5F), {});
  RegularisedOptions options;
  options.iterations = 4;
  size_t calls = 0, last = 0;
  ASSERT_TRUE(reconstruct_regularised(images, capture::default_codes(), {}, options, [&](size_t done, size_t total) {
    ++calls;
    last = done;
    EXPECT_EQ(total, 4U);
  }));
  EXPECT_EQ(calls, 4U);
  EXPECT_EQ(last, 4U);
}

TEST(Regularised, FailsAsTheInversionDoes) {
  capture::Codes open = capture::default_codes();
  std::fill(open.values.begin(), open.values.end(), 1.0F);
  const capture::EventImages images(3, 16, 16);
  EXPECT_EQ(reconstruct_regularised(images, open, {}).error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(reconstruct_regularised(capture::EventImages(2, 16, 16), capture::default_codes(), {}).error().code,
            ErrorCode::kShape);
  EXPECT_EQ(reconstruct_regularised(capture::EventImages(3, 0, 16), capture::default_codes(), {}).error().code,
            ErrorCode::kShape);
  capture::Codes black = capture::default_codes();
  std::fill(black.values.begin(), black.values.end(), 0.0F);
  EXPECT_EQ(reconstruct_regularised(images, black, {}).error().code, ErrorCode::kInvalidValue);
}

}  // namespace
}  // namespace e2lf::recon
