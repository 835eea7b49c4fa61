// SPDX-License-Identifier: MIT
#include "e2lf/report/chart.h"

#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <regex>

namespace e2lf::report {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::Pointwise;

TEST(RoundTicks, AreTheFinestThatAreFewEnough) {
  EXPECT_THAT(round_ticks(0, 10, 11).values, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10));
  EXPECT_THAT(round_ticks(0, 10, 10).values, ElementsAre(0, 2, 4, 6, 8, 10));
  EXPECT_THAT(round_ticks(0, 10, 5).values, ElementsAre(0, 5, 10));
  EXPECT_THAT(round_ticks(-7, 12, 4).values, ElementsAre(-5, 0, 5, 10));
}

TEST(RoundTicks, DecimalStepsHitTheirEnds) {
  const Ticks ticks = round_ticks(0.1, 0.3, 3);
  EXPECT_THAT(ticks.values, Pointwise(DoubleNear(1e-12), {0.1, 0.2, 0.3}));
  EXPECT_EQ(ticks.decimals, 1);
  EXPECT_EQ(tick_text(ticks.values[2], ticks.decimals), "0.3");
}

TEST(RoundTicks, LieInTheRangeAndAreMultiplesForAnyRange) {
  for (const double low : {-3e6, -17.3, 0.0, 1e-7, 28.41}) {
    for (const double length : {1e-6, 0.07, 1.0, 33.0, 9e5}) {
      const Ticks ticks = round_ticks(low, low + length, 8);
      ASSERT_THAT(ticks.values.size(), testing::AllOf(testing::Ge(2U), testing::Le(8U))) << low << " " << length;
      for (const double value : ticks.values) {
        EXPECT_GE(value, low - 1e-8 * ticks.step - 1e-9);
        EXPECT_LE(value, low + length + 1e-8 * ticks.step + 1e-9);
      }
    }
  }
}

TEST(TickText, HasNoNegativeZero) {
  EXPECT_EQ(tick_text(-0.0001, 2), "0.00");
  EXPECT_EQ(tick_text(-0.5, 1), "-0.5");
}

TEST(LineChart, PointsLieWhereTheTicksSay) {
  LineChart chart{"time", "dB", {{"a", {{0, 0}, {10, 10}}}}};
  const std::string svg = chart_svg(chart);
  const std::regex points("points=\"([0-9.]+),([0-9.]+) ([0-9.]+),([0-9.]+) \"");
  std::smatch match;
  ASSERT_TRUE(std::regex_search(svg, match, points));
  EXPECT_NEAR(std::stod(match[2]) - std::stod(match[4]), 320, 1e-3);
  EXPECT_NEAR(std::stod(match[3]), 1170, 1e-3);
}

TEST(LineChart, AFilledLineEndsAtZero) {
  const LineChart chart{"x", "y", {{"a", {{0, -2}, {1, -1}}, /*is_filled=*/true}}, /*has_signs=*/false};
  const std::string svg = chart_svg(chart);
  const std::regex points("points=\"[0-9.]+,([0-9.]+) [0-9.]+,([0-9.]+) [0-9.]+,([0-9.]+) [0-9.]+,([0-9.]+)\"");
  std::smatch match;
  ASSERT_TRUE(std::regex_search(svg, match, points));
  EXPECT_EQ(match[1], match[4]);
  EXPECT_NEAR(std::stod(match[2]) - std::stod(match[1]), 320, 1e-3);
  EXPECT_THAT(svg, HasSubstr(">2.0<"));
  EXPECT_THAT(svg, Not(HasSubstr(">-2.0<")));
}

TEST(LineChart, BandsAndMarksLieWhereTheTicksSay) {
  LineChart chart{"x", "y", {{"a", {{0, 1}, {10, 2}}}}};
  chart.bands = {"found", {{5, 10, 0.25, "7: 0.90"}, {20, 30, 0.25, "outside"}}};
  chart.marks = {{"ticks", {{5, 1}, {11, 1}}, {}}, {"none", {}, {}}};
  const std::string svg = chart_svg(chart);
  const std::regex band("<rect x=\"([0-9.]+)\" y=\"[0-9.]+\" width=\"([0-9.]+)\"[^>]*fill-opacity=\"0.25\"");
  std::smatch match;
  ASSERT_TRUE(std::regex_search(svg, match, band));
  const double begin = std::stod(match[1]), end = begin + std::stod(match[2]);
  EXPECT_NEAR(end, 1170 - 1, 1e-3) << "with a gap of one px before the next band";
  const std::regex mark("<line x1=\"([0-9.]+)\"[^>]*stroke-width=\"1.5\"");
  std::sregex_iterator found(svg.begin(), svg.end(), mark);
  EXPECT_NEAR(std::stod((*found)[1]), begin, 1e-3);
  EXPECT_EQ(++found, std::sregex_iterator()) << "what lies outside is left out";
  EXPECT_THAT(svg, HasSubstr(">7: 0.90<"));
  EXPECT_THAT(svg, HasSubstr(">ticks<"));
  EXPECT_THAT(svg, Not(HasSubstr(">none<")));
}

TEST(FileSvg, FillsTheWidthInTheThemeOfTheReader) {
  const std::string svg = file_svg(chart_svg(LineChart{}));
  const size_t background = svg.find("fill=\"white\"");
  ASSERT_NE(background, std::string::npos) << "for programs without style sheets";
  EXPECT_LT(background, svg.find("<text"));
  EXPECT_THAT(svg.substr(0, svg.find('>')), HasSubstr("width=\"100%\""));
  EXPECT_THAT(svg, HasSubstr("prefers-color-scheme:dark"));
}

TEST(FileSvg, HasAMarginAround) {
  const std::string chart = chart_svg(LineChart{"x", "y", {{"a", {{0, 1}, {3, 2}}}}});
  const std::string svg = file_svg(chart);
  const std::regex size("viewBox=\"(-?[0-9.]+) (-?[0-9.]+) ([0-9.]+) ([0-9.]+)");
  std::smatch inner, outer;
  ASSERT_TRUE(std::regex_search(chart, inner, size));
  ASSERT_TRUE(std::regex_search(svg, outer, size));
  for (const int axis : {1, 2}) {
    const double margin = -std::stod(outer[axis]);
    EXPECT_GE(margin, 10);
    EXPECT_NEAR(std::stod(outer[axis + 2]), std::stod(inner[axis + 2]) + 2 * margin, 1e-9);
  }
}

TEST(Charts, AreToldFromGrids) {
  EXPECT_TRUE(is_chart(chart_svg(LineChart{})));
  EXPECT_FALSE(is_chart(grid_svg({0, 1}, 2)));
}

TEST(LineChart, WhatIsNotFiniteIsLeftOut) {
  const LineChart chart{"x", "y", {{"a", {{0, 1}, {1, INFINITY}, {2, NAN}, {3, 2}}}}};
  const std::string svg = chart_svg(chart);
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
}

TEST(Charts, DrawNothingAndOneValue) {
  EXPECT_THAT(chart_svg(LineChart{}), HasSubstr("</svg>"));
  EXPECT_THAT(chart_svg(LineChart{"x", "y", {{"a", {{3, 28}}}}}), HasSubstr(">3.0<"));
}

TEST(Charts, EscapeNames) {
  const std::string svg = chart_svg(LineChart{"<script>", "y", {{"a & b", {{0, 1}}}}});
  EXPECT_THAT(svg, Not(HasSubstr("<script>")));
  EXPECT_THAT(svg, HasSubstr("a &amp; b"));
}

TEST(Grid, BrightnessIsTheValue) {
  const std::string svg = grid_svg({0, 1}, 2);
  EXPECT_THAT(svg, HasSubstr("rgb(0,0,0)"));
  EXPECT_THAT(svg, HasSubstr("rgb(255,255,255)"));
}

}  // namespace
}  // namespace e2lf::report
