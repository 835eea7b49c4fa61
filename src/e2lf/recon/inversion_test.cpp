// SPDX-License-Identifier: MIT
#include "e2lf/recon/inversion.h"

#include <cmath>
#include <gtest/gtest.h>

namespace e2lf::recon {
namespace {

constexpr double kEps = 0.01, kTau = 0.30;

TEST(Inversion, ClosedFormHoldsOnBothSidesOfTheBlackPattern) {
  events::EventImages images(3, 1, 1);
  images.counts = {-4, 7, -2};
  const auto intensities = invert_events(images, {.black = 1});
  ASSERT_TRUE(intensities);
  const auto expected = [](int level) { return kEps * (std::exp(kTau * level) - 1); };
  EXPECT_NEAR(intensities->image(0)[0], expected(4), 1e-6);  // before black: the sign turns
  EXPECT_EQ(intensities->image(1)[0], 0);
  EXPECT_NEAR(intensities->image(2)[0], expected(7), 1e-6);
  EXPECT_NEAR(intensities->image(3)[0], expected(5), 1e-6);
}

TEST(Inversion, CentringAddsHalfAThresholdTowardTheLastChange) {
  events::EventImages images(4, 1, 1);
  images.counts = {0, 3, 0, -1};
  const auto intensities = invert_events(images, {.black = 0, .centred = true});
  ASSERT_TRUE(intensities);
  const double levels[] = {0, 0, 3.5, 3.5, 1.5};
  for (size_t n = 0; n < 5; ++n) EXPECT_NEAR(intensities->image(n)[0], kEps * std::expm1(kTau * levels[n]), 1e-6) << n;
}

TEST(Inversion, WrongInputsAreRefused) {
  const events::EventImages images(3, 1, 1);
  for (const InversionOptions& options : {InversionOptions{.black = 4}, InversionOptions{.constants = {.eps = 0}},
                                          InversionOptions{.constants = {.tau = -1}}}) {
    const auto intensities = invert_events(images, options);
    ASSERT_FALSE(intensities);
    EXPECT_EQ(intensities.error().code, ErrorCode::kInvalidValue);
  }
}

}  // namespace
}  // namespace e2lf::recon
