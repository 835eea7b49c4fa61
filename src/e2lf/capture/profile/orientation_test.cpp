// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "e2lf/capture/profile/sensor_profile.h"

namespace e2lf::capture {
namespace {

constexpr Orientation kAll[] = {{false, false}, {true, false}, {false, true}, {true, true}};

TEST(Orientation, IsItsOwnInverse) {
  for (const Orientation& orientation : kAll) EXPECT_TRUE((orientation + orientation).is_upright());
}

TEST(Orientation, TurnedIsBothFlips) {
  EXPECT_EQ((Orientation{true, false} + Orientation{false, true}), kTurned);
  EXPECT_EQ((kTurned + Orientation{true, false}), (Orientation{false, true}));
}

TEST(Orientation, ComesBackByItsName) {
  for (const Orientation& orientation : kAll) {
    EXPECT_EQ(orientation_from_name(orientation_name(orientation), "").value(), orientation);
  }
  const auto unknown = orientation_from_name("rotated", "mine.json: $.views");
  ASSERT_FALSE(unknown.ok());
  EXPECT_EQ(unknown.error().code, ErrorCode::kInvalidValue);
  EXPECT_EQ(unknown.error().location, "mine.json: $.views");
  EXPECT_NE(unknown.error().message.find("flipped-x"), std::string::npos);
}

}  // namespace
}  // namespace e2lf::capture
