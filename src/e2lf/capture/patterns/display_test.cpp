// SPDX-License-Identifier: MIT
#include "e2lf/capture/patterns/display.h"

#include <gtest/gtest.h>
#include <numeric>

namespace e2lf::capture {
namespace {

/// One pattern of 2x3 cells whose transmittances are all different.
Codes numbered() {
  Codes codes(1, 2, 3);
  for (size_t i = 0; i < 6; ++i) codes.values[i] = static_cast<float>(i + 1) / 10.0F;
  return codes;
}

/// The tenths that each cell shows, read off the middle of the cells.
std::vector<int> cells(const DisplayFrame& frame, size_t cell_px, size_t rows, size_t columns) {
  const size_t first_x = (frame.width_px - columns * cell_px) / 2, first_y = (frame.height_px - rows * cell_px) / 2;
  std::vector<int> values;
  for (size_t row = 0; row < rows; ++row) {
    for (size_t column = 0; column < columns; ++column) {
      const size_t y = first_y + row * cell_px + cell_px / 2, x = first_x + column * cell_px + cell_px / 2;
      values.push_back((frame.pixels[y * frame.width_px + x] + 12) * 10 / 255);
    }
  }
  return values;
}

TEST(Display, PutsThePapersApertureIntoTheMiddle) {
  Codes codes(2, 8, 8);
  std::fill(codes.pattern(1).begin(), codes.pattern(1).end(), 1.0F);
  const auto frame = render_pattern(codes, 1, {});
  ASSERT_TRUE(frame) << frame.error().text();
  ASSERT_EQ(frame->pixels.size(), 1280U * 1024U);
  const auto at = [&](size_t x, size_t y) { return frame->pixels[y * 1280 + x]; };
  EXPECT_EQ(at(240, 112), 255);
  EXPECT_EQ(at(1039, 911), 255);
  EXPECT_EQ(at(239, 112), 0);
  EXPECT_EQ(at(240, 111), 0);
  EXPECT_EQ(at(1040, 911), 0);
  EXPECT_EQ(std::accumulate(frame->pixels.begin(), frame->pixels.end(), uint64_t{0}), uint64_t{255} * 800 * 800);
  const auto black = render_pattern(codes, 0, {}).value();
  EXPECT_EQ(std::accumulate(black.pixels.begin(), black.pixels.end(), 0), 0);
}

TEST(Display, FlipsThenTurnsClockwise) {
  DisplayLayout layout{.width_px = 40, .height_px = 40, .cell_px = 10};
  EXPECT_EQ(cells(*render_pattern(numbered(), 0, layout), 10, 2, 3), (std::vector<int>{1, 2, 3, 4, 5, 6}));
  layout.quarter_turns = 1;
  EXPECT_EQ(cells(*render_pattern(numbered(), 0, layout), 10, 3, 2), (std::vector<int>{4, 1, 5, 2, 6, 3}));
  layout.quarter_turns = 2;
  EXPECT_EQ(cells(*render_pattern(numbered(), 0, layout), 10, 2, 3), (std::vector<int>{6, 5, 4, 3, 2, 1}));
  layout.quarter_turns = 1;
  layout.flip_x = true;
  EXPECT_EQ(cells(*render_pattern(numbered(), 0, layout), 10, 3, 2), (std::vector<int>{6, 3, 5, 2, 4, 1}));
  layout = {.width_px = 40, .height_px = 40, .cell_px = 10, .flip_y = true};
  EXPECT_EQ(cells(*render_pattern(numbered(), 0, layout), 10, 2, 3), (std::vector<int>{4, 5, 6, 1, 2, 3}));
}

TEST(Display, MovesByTheOffsetAndRefusesWhatDoesNotFit) {
  DisplayLayout layout{.width_px = 40, .height_px = 30, .cell_px = 10, .offset_x_px = 5, .offset_y_px = -5};
  const auto frame = render_pattern(numbered(), 0, layout);
  ASSERT_TRUE(frame) << frame.error().text();
  EXPECT_EQ(frame->pixels[0 * 40 + 9], 0);
  EXPECT_NE(frame->pixels[0 * 40 + 10], 0);
  EXPECT_EQ(frame->pixels[20 * 40 + 10], 0);
  layout.offset_x_px = 6;
  EXPECT_EQ(render_pattern(numbered(), 0, layout).error().code, ErrorCode::kInvalidValue);
  layout = {.width_px = 29, .height_px = 30, .cell_px = 10};
  EXPECT_EQ(render_pattern(numbered(), 0, layout).error().code, ErrorCode::kInvalidValue);
  layout = {.width_px = size_t{1} << 40, .height_px = size_t{1} << 40};
  EXPECT_EQ(render_pattern(numbered(), 0, layout).error().code, ErrorCode::kInvalidValue);
}

}  // namespace
}  // namespace e2lf::capture
