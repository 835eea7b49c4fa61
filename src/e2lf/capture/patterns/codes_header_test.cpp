// SPDX-License-Identifier: MIT
#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "e2lf/capture/patterns/codes.h"

namespace e2lf::capture {
namespace {

using testing::HasSubstr;

TEST(CodesHeader, HoldsBinaryPatternsAsRowsOfDigits) {
  const HeaderLines header = codes_to_header(default_codes());
  ASSERT_EQ(header.size(), 4U);
  EXPECT_EQ(header[1].first, "e2lf_pattern_2");
  EXPECT_THAT(header[1].second, HasSubstr("/01100000/11110000/"));
}

TEST(CodesHeader, GivesThePatternsBackFromAmongOtherLinesInAnyOrder) {
  Codes grey(2, 2, 3);
  grey.values = {0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.1F, 0.2F, 0.3F, 1.0F, 0.0F, 1.0F};
  for (const Codes& codes : {default_codes(), grey}) {
    HeaderLines header = codes_to_header(codes);
    header.insert(header.begin(), {"geometry", "1280x720"});
    std::reverse(header.begin(), header.end());
    const auto read = codes_from_header(header, "a.raw");
    ASSERT_TRUE(read) << read.error().text();
    EXPECT_EQ(*read, codes);
  }
}

TEST(CodesHeader, IsNothingWithoutPatterns) {
  const auto read = codes_from_header({{"geometry", "1280x720"}}, "a.raw");
  ASSERT_TRUE(read);
  EXPECT_FALSE(read->has_value());
}

TEST(CodesHeader, NamesThePatternThatIsMissingOrDamaged) {
  HeaderLines header = codes_to_header(default_codes());
  header[2].second[3] = 'x';
  EXPECT_THAT(codes_from_header(header, "a.raw").error().text(), HasSubstr("a.raw: e2lf_pattern_3"));
  header.erase(header.begin() + 1);
  EXPECT_THAT(codes_from_header(header, "a.raw").error().text(), HasSubstr("a.raw: e2lf_pattern_2"));
}

}  // namespace
}  // namespace e2lf::capture
