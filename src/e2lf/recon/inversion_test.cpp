// SPDX-License-Identifier: MIT
#include "e2lf/recon/inversion.h"

#include <cmath>
#include <gtest/gtest.h>

#include "e2lf/base/rng.h"

namespace e2lf::recon {
namespace {

constexpr double kEps = 0.01, kTau = 0.30;

/// Noise-free events straight from Eq. 9 and 10, in double precision.
capture::EventImages count_events(const capture::CodedIntensities& intensities) {
  capture::EventImages images(intensities.count - 1, intensities.height, intensities.width);
  for (size_t pixel = 0; pixel < images.image_size(); ++pixel) {
    double reference = std::log(double{intensities.image(0)[pixel]} + kEps);
    for (size_t k = 0; k < images.count; ++k) {
      const double now = std::log(double{intensities.image(k + 1)[pixel]} + kEps);
      const double count = std::trunc((now - reference) / kTau);
      images.image(k)[pixel] = static_cast<int16_t>(count);
      reference += kTau * count;
    }
  }
  return images;
}

/// Dark to bright noise; pattern `black` sees nothing.
capture::CodedIntensities random_intensities(size_t black) {
  capture::CodedIntensities intensities(5, 40, 50);
  const CounterRng rng(4, black);
  for (size_t i = 0; i < intensities.values.size(); ++i) intensities.values[i] = std::exp(-6.0F * rng.uniform(i));
  for (float& value : intensities.image(black)) value = 0;
  return intensities;
}

TEST(Inversion, ClosedFormHoldsOnBothSidesOfTheBlackPattern) {
  capture::EventImages images(3, 1, 1);
  images.values = {-4, 7, -2};
  const auto intensities = invert_events(images, {.black = 1});
  ASSERT_TRUE(intensities);
  const auto expected = [](int level) { return kEps * (std::exp(kTau * level) - 1); };
  EXPECT_NEAR(intensities->image(0)[0], expected(4), 1e-6);  // before black: the sign turns
  EXPECT_EQ(intensities->image(1)[0], 0);
  EXPECT_NEAR(intensities->image(2)[0], expected(7), 1e-6);
  EXPECT_NEAR(intensities->image(3)[0], expected(5), 1e-6);
}

TEST(Inversion, CentringAddsHalfAThresholdTowardTheLastChange) {
  capture::EventImages images(4, 1, 1);
  images.values = {0, 3, 0, -1};
  const auto intensities = invert_events(images, {.black = 0, .centred = true});
  ASSERT_TRUE(intensities);
  const double levels[] = {0, 0, 3.5, 3.5, 1.5};
  for (size_t n = 0; n < 5; ++n) EXPECT_NEAR(intensities->image(n)[0], kEps * std::expm1(kTau * levels[n]), 1e-6) << n;
}

TEST(Inversion, NoiseFreeIntensitiesLieWithinOneThreshold) {
  const auto truth = random_intensities(0);
  const auto images = count_events(truth);
  const auto intensities = invert_events(images, {});
  ASSERT_TRUE(intensities);
  const auto level = [](float value) { return std::log(double{value} + kEps) / kTau; };
  for (size_t i = 0; i < truth.values.size(); ++i) {
    ASSERT_NEAR(level(intensities->values[i]), level(truth.values[i]), 1 + 1e-4);
  }
}

TEST(Inversion, WrongInputsAreRefused) {
  const capture::EventImages images(3, 1, 1);
  for (const InversionOptions& options : {InversionOptions{.black = 4}, InversionOptions{.constants = {.eps = 0}},
                                          InversionOptions{.constants = {.tau = -1}}}) {
    const auto intensities = invert_events(images, options);
    ASSERT_FALSE(intensities);
    EXPECT_EQ(intensities.error().code, ErrorCode::kInvalidValue);
  }
}

}  // namespace
}  // namespace e2lf::recon
