// SPDX-License-Identifier: MIT
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/lightfield/views.h"
#include "testing/test_files.h"

namespace e2lf::lightfield {
namespace {

namespace fs = std::filesystem;
using capture::kTurned;
using capture::Orientation;

constexpr Orientation kFlippedX{true, false}, kFlippedY{false, true};

/// Each value says which view and pixel it is of.
LightField numbered(const Shape& shape) {
  LightField field(shape);
  for (size_t i = 0; i < shape.size(); ++i) field.data()[i] = static_cast<float>(i) / static_cast<float>(shape.size());
  return field;
}

TEST(Orient, MovesViewsAndLeavesPicturesAsTheyAre) {
  const LightField before = numbered({3, 4, 2, 3, 1});
  for (const Orientation& orientation : {kFlippedX, kFlippedY, kTurned}) {
    LightField after = before;
    orient(after, orientation);
    for (size_t row = 0; row < 3; ++row) {
      for (size_t column = 0; column < 4; ++column) {
        const auto from = before.view(orientation.flip_y ? 2 - row : row, orientation.flip_x ? 3 - column : column);
        const auto to = after.view(row, column);
        EXPECT_TRUE(std::equal(from.begin(), from.end(), to.begin())) << row << ' ' << column;
      }
    }
  }
}

TEST(Orient, ComposesAsOrientationsDo) {
  const LightField before = numbered({8, 8, 2, 2, 3});
  LightField both = before, turned = before, back = before;
  orient(both, kFlippedX);
  orient(both, kFlippedY);
  orient(turned, kFlippedX + kFlippedY);
  orient(back, kTurned);
  orient(back, kTurned);
  EXPECT_TRUE(std::equal(both.data().begin(), both.data().end(), turned.data().begin()));
  EXPECT_TRUE(std::equal(back.data().begin(), back.data().end(), before.data().begin()));
}

/// A near edge that moves by `step_y` down and `step_x` to the right from view to view.
LightField moving_dot(int step_y, int step_x) {
  LightField field({8, 8, 32, 32, 1});
  for (int row = 0; row < 8; ++row) {
    for (int column = 0; column < 8; ++column) {
      field.at(row, column, 16 + step_y * (row - 4), 16 + step_x * (column - 4)) = 1.0F;
    }
  }
  return field;
}

/// How far the dot moves from a view to the next, below it and to the right of it.
std::pair<int, int> disparities(const LightField& field) {
  const auto place = [&](size_t row, size_t column) {
    const auto view = field.view(row, column);
    const auto i = static_cast<int>(std::max_element(view.begin(), view.end()) - view.begin());
    return std::pair(i / 32, i % 32);
  };
  return {place(4, 3).first - place(3, 3).first, place(3, 4).second - place(3, 3).second};
}

TEST(Orient, GivesDisparitiesTheirSign) {
  for (const auto& [sign_y, sign_x, orientation] :
       {std::tuple(1, 1, kTurned), std::tuple(-1, 1, kFlippedX), std::tuple(1, -1, kFlippedY)}) {
    LightField field = moving_dot(sign_y, sign_x);
    orient(field, orientation);
    EXPECT_EQ(disparities(field), std::pair(-1, -1));
  }
}

class StoredOrientation : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(write_light_field(folder_ / "lightfield.npy", field_, {.format = LightFieldFormat::kNpy}).ok());
  }

  void record(const Json& notes, const std::string& writer = "e2lf") const {
    std::ofstream(folder_ / "run.json") << Json{{"written_by", writer}, {"notes", notes}}.dump();
  }

  const TestFolder test_folder_;
  const fs::path& folder_ = test_folder_.path();
  const LightField field_ = numbered({2, 2, 3, 4, 1});
};

TEST_F(StoredOrientation, IsHeededByReadingAndLeavesTheFileAlone) {
  record({{"views", views_note(kTurned, kTurned)}});
  LightField turned = field_;
  orient(turned, kTurned);
  ReadOptions all;
  all.views_y.count = all.views_x.count = 0;
  for (const fs::path& path : {folder_, folder_ / "lightfield.npy"}) {
    const auto read = read_light_field(path, all);
    ASSERT_TRUE(read.ok()) << read.error().message;
    EXPECT_TRUE(std::equal(read->data().begin(), read->data().end(), turned.data().begin()));
  }
  ReadOptions back = all;
  back.orientation = kTurned;
  const auto plain = read_light_field(folder_, back);
  ASSERT_TRUE(plain.ok());
  EXPECT_TRUE(std::equal(plain->data().begin(), plain->data().end(), field_.data().begin()));
}

TEST_F(StoredOrientation, IsUprightWithoutARecordOfOurs) {
  EXPECT_EQ(stored_orientation(folder_).value(), Orientation{});
  record({{"views", views_note(kTurned, kTurned)}}, "another program");
  EXPECT_EQ(stored_orientation(folder_).value(), Orientation{});
  record({{"views", views_note(kTurned, {})}});
  EXPECT_EQ(stored_orientation(folder_).value(), Orientation{});
  record({{"gain", 2}});
  EXPECT_EQ(stored_orientation(folder_).value(), Orientation{});
}

TEST_F(StoredOrientation, RefusesANoteThatItDoesNotKnow) {
  for (const Json& stored : {Json("sideways"), Json(3)}) {
    record({{"views", {{"stored", stored}}}});
    const auto failed = stored_orientation(folder_);
    ASSERT_FALSE(failed.ok());
    EXPECT_NE(failed.error().location.find("run.json"), std::string::npos);
  }
}

}  // namespace
}  // namespace e2lf::lightfield
