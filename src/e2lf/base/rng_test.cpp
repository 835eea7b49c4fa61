// SPDX-License-Identifier: MIT
#include "e2lf/base/rng.h"

#include <gtest/gtest.h>
#include <set>

#include "e2lf/base/result.h"

namespace e2lf {
namespace {

using Words = std::array<uint32_t, 4>;

// The known answers of Random123 (kat_vectors, philox4x32 10).
TEST(Philox, GivesTheKnownAnswers) {
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, {0, 0}), (Words{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox4x32({~0U, ~0U, ~0U, ~0U}, {~0U, ~0U}), (Words{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(CounterRng, PlacesSeedStreamAndIndexAsDocumented) {
  const CounterRng rng(0x299f31d0a4093822, 0x0370734413198a2e);
  EXPECT_EQ(rng.bits(0x85a308d3243f6a88), (Words{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(CounterRng, DrawsDifferentWordsForEachSeedStreamAndIndex) {
  std::set<Words> seen;
  for (uint64_t value = 0; value < 16; ++value) {
    seen.insert(CounterRng(value, 100).bits(200));
    seen.insert(CounterRng(300, value).bits(200));
    seen.insert(CounterRng(300, 100).bits(value));
  }
  EXPECT_EQ(seen.size(), 48U);
}

TEST(CounterRng, UniformHasTheMomentsOfTheUnitInterval) {
  const CounterRng rng(1, 2);
  constexpr size_t kDraws = 200000;
  double sum = 0.0, squares = 0.0;
  for (size_t i = 0; i < kDraws; ++i) {
    const float value = rng.uniform(i);
    ASSERT_GE(value, 0.0F);
    ASSERT_LT(value, 1.0F);
    sum += value;
    squares += static_cast<double>(value) * value;
  }
  // Five standard errors: sqrt(1/12 / n) of the mean, sqrt(4/45 / n) of the mean square.
  EXPECT_NEAR(sum / kDraws, 0.5, 5 * std::sqrt(1.0 / 12 / kDraws));
  EXPECT_NEAR(squares / kDraws, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / kDraws));
}

TEST(CounterRng, NormalsHaveTheMomentsOfTheStandardNormalAndAreIndependent) {
  const CounterRng rng(7, 3);
  constexpr size_t kPairs = 200000;
  double mean[2] = {}, square[2] = {}, fourth[2] = {}, product = 0.0;
  for (size_t i = 0; i < kPairs; ++i) {
    const auto pair = rng.normal2(i);
    product += static_cast<double>(pair[0]) * pair[1];
    for (int k = 0; k < 2; ++k) {
      const double z = pair[static_cast<size_t>(k)];
      ASSERT_TRUE(std::isfinite(z));
      mean[k] += z;
      square[k] += z * z;
      fourth[k] += z * z * z * z;
    }
  }
  const double error = 5 / std::sqrt(static_cast<double>(kPairs));  // times the standard deviation of each statistic
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(mean[k] / kPairs, 0.0, error);
    EXPECT_NEAR(square[k] / kPairs, 1.0, error * std::sqrt(2.0));
    EXPECT_NEAR(fourth[k] / kPairs, 3.0, error * std::sqrt(96.0));
  }
  EXPECT_NEAR(product / kPairs, 0.0, error);
}

TEST(CounterRng, BelowStaysInRangeAndReachesEveryValue) {
  const CounterRng rng(5, 0);
  std::array<size_t, 7> counts{};
  constexpr size_t kDraws = 70000;
  for (size_t i = 0; i < kDraws; ++i) {
    const uint32_t value = rng.below(i, 7);
    ASSERT_LT(value, 7U);
    ++counts[value];
  }
  const double error = 5 * std::sqrt(kDraws / 7.0);
  for (const size_t count : counts) EXPECT_NEAR(static_cast<double>(count), kDraws / 7.0, error);
  EXPECT_EQ(rng.below(3, 1), 0U);
  EXPECT_THROW((void)rng.below(3, 0), ContractError);
}

}  // namespace
}  // namespace e2lf
