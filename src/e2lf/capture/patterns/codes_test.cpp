// SPDX-License-Identifier: MIT
#include "e2lf/capture/patterns/codes.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace e2lf::capture {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Codes two_patterns() {
  Codes codes(2, 1, 4);
  codes.values = {0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.25F, 0.75F, 1.0F};
  return codes;
}

TEST(Codes, ValidateRefusesWhatIsNoTransmittanceAndNamesTheCell) {
  EXPECT_TRUE(validate(two_patterns(), "x").ok());
  for (const float bad : {-0.1F, 1.1F, NAN, INFINITY}) {
    Codes codes(2, 8, 8);
    codes.pattern(1)[3 * 8 + 5] = bad;
    const Error error = validate(codes, "c.json").error();
    EXPECT_EQ(error.code, ErrorCode::kInvalidValue) << bad;
    EXPECT_EQ(error.location, "c.json");
    EXPECT_THAT(error.message, HasSubstr("pattern 2, row 3, column 5"));
  }
}

TEST(Codes, ValidateRefusesSizesThatDoNotFit) {
  Codes codes = two_patterns();
  codes.num_patterns = 3;
  EXPECT_EQ(validate(codes, "x").error().code, ErrorCode::kShape);
  EXPECT_EQ(validate(Codes(), "x").error().code, ErrorCode::kShape);
}

TEST(Codes, BlackFirstNeedsEveryCellOfTheFirstPatternClosed) {
  Codes codes = two_patterns();
  EXPECT_TRUE(is_black_first(codes));
  codes.values[3] = 0.001F;
  EXPECT_FALSE(is_black_first(codes));
  EXPECT_FALSE(is_black_first(Codes()));
}

TEST(Codes, BinaryMeansOnlyZeroAndOne) {
  EXPECT_FALSE(is_binary(two_patterns()));
  EXPECT_TRUE(is_binary(default_codes()));
}

TEST(Codes, LightEfficiencyIsTheMeanTransmittance) {
  EXPECT_THAT(light_efficiency(two_patterns()), ElementsAre(0.0F, 0.5F));
}

TEST(Codes, PatternAndComplementAddUpToTheOpenAperture) {
  const Codes codes = two_patterns();
  const Codes rest = complement(codes);
  for (size_t i = 0; i < codes.values.size(); ++i) EXPECT_EQ(codes.values[i] + rest.values[i], 1.0F);
}

TEST(DefaultCodes, AreBlackThenThreeEqualBlobsOverTwoBaseLines) {
  const Codes codes = default_codes();
  ASSERT_TRUE(validate(codes, "x").ok());
  EXPECT_EQ(codes.num_patterns, 4U);
  EXPECT_TRUE(is_black_first(codes));
  EXPECT_THAT(light_efficiency(codes), ElementsAre(0.0F, 0.1875F, 0.1875F, 0.1875F));
  // Centres of gravity, {view_y, view_x}.
  std::vector<std::pair<float, float>> centres;
  for (size_t n = 1; n < 4; ++n) {
    float y = 0.0F, x = 0.0F;
    for (size_t cell = 0; cell < 64; ++cell) {
      y += codes.pattern(n)[cell] * static_cast<float>(cell / 8) / 12.0F;
      x += codes.pattern(n)[cell] * static_cast<float>(cell % 8) / 12.0F;
    }
    centres.emplace_back(std::round(y * 10.0F) / 10.0F, std::round(x * 10.0F) / 10.0F);
  }
  EXPECT_THAT(centres, ElementsAre(std::pair(5.5F, 1.5F), std::pair(5.5F, 5.5F), std::pair(1.5F, 5.5F)));
}

}  // namespace
}  // namespace e2lf::capture
