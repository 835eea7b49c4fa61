// SPDX-License-Identifier: MIT
#include <algorithm>
#include <gtest/gtest.h>

#include "e2lf/diagnose/event_images.h"
#include "e2lf/lightfield/scene.h"
#include "e2lf/sensor/event_model.h"

namespace e2lf::diagnose {
namespace {

/// Black and three small openings: at the left, at the bottom right, and at the top right.
capture::Codes three_openings() {
  capture::Codes codes(4, 8, 8);
  const size_t corners[3][2] = {{2, 0}, {6, 6}, {1, 6}};
  for (size_t n = 0; n < 3; ++n) {
    for (const size_t cell : {0U, 1U, 8U, 9U}) {
      codes.pattern(n + 1)[corners[n][0] * 8 + corners[n][1] + cell] = 1.0F;
    }
  }
  return codes;
}

capture::EventImages events_of(const capture::Codes& shown) {
  static const lightfield::LightField scene =
      lightfield::render_light_field(lightfield::demo_scene(), {8, 8, 120, 160}, 4);
  return sensor::simulate_events(shown, scene, {}).value();
}

/// Returns the patterns with the order of their columns reversed.
capture::Codes mirrored(capture::Codes codes) {
  for (size_t n = 0; n < codes.num_patterns; ++n) {
    for (size_t row = 0; row < 8; ++row) std::ranges::reverse(codes.pattern(n).subspan(8 * row, 8));
  }
  return codes;
}

/// Returns the change with the least mismatch, or nothing if the stated places agree best.
std::string best_for(const capture::Codes& shown) {
  const auto places = compare_places(events_of(shown), three_openings(), 1.0F);
  const auto best = std::ranges::min_element(places, {}, &OtherPlaces::mismatch);
  return best->mismatch < 0.98 ? best->name : "";
}

TEST(ComparePlaces, NamesExchangedAndTurnedPatterns) {
  const capture::Codes codes = three_openings();
  EXPECT_EQ(best_for(codes), "");
  capture::Codes shown = codes;
  std::ranges::swap_ranges(shown.pattern(2), shown.pattern(3));
  EXPECT_EQ(best_for(shown), "with the patterns a3 and a4 exchanged");
  EXPECT_EQ(best_for(mirrored(codes)), "with mirrored patterns");
}

TEST(ComparePlaces, KnowsTheOrientationOfTheViews) {
  const capture::EventImages events = events_of(mirrored(three_openings()));
  EXPECT_EQ(check_places(events, three_openings(), {})->code, "orientation-better-changed");
  EXPECT_FALSE(check_places(events, three_openings(), {}, capture::Orientation{.flip_x = true}));
  EXPECT_FALSE(check_places(events, three_openings(), {}, capture::Orientation{.flip_y = true}));
  EXPECT_TRUE(check_places(events_of(three_openings()), three_openings(), {}, capture::Orientation{.flip_x = true}));
}

TEST(ComparePlaces, ExchangesPatternsOnlyIfTheyAreFew) {
  constexpr size_t kOrientations = std::size(kOtherOrientations);
  for (const auto& [lit, exchanges] : {std::pair(8, 28), std::pair(9, 0)}) {
    capture::Codes codes(static_cast<size_t>(lit) + 1, 8, 8);
    for (size_t n = 1; n < codes.num_patterns; ++n) codes.pattern(n)[7 * n % 64] = 1;
    const capture::EventImages events(static_cast<size_t>(lit), 20, 20);
    EXPECT_EQ(compare_places(events, codes, 1).size(), static_cast<size_t>(exchanges) + kOrientations) << lit;
  }
}

TEST(ComparePlaces, StatesThatAFlatSceneTellsNothing) {
  lightfield::LightField wall(lightfield::Shape{8, 8, 60, 80, 1});
  std::ranges::fill(wall.data(), 0.4F);
  const auto finding = check_places(sensor::simulate_events(three_openings(), wall, {}).value(), three_openings(), {});
  ASSERT_TRUE(finding);
  EXPECT_EQ(finding->code, "patterns-undecided");
  EXPECT_EQ(finding->severity, Severity::kNote);
}

TEST(ComparePlaces, SaysNothingWithoutThreePlaces) {
  const capture::Codes two(3, 8, 8);
  EXPECT_TRUE(compare_places(capture::EventImages(2, 20, 20), two, 1).empty());
  EXPECT_TRUE(compare_places(capture::EventImages(2, 20, 20), three_openings(), 1).empty());
}

}  // namespace
}  // namespace e2lf::diagnose
