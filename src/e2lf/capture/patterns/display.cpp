// SPDX-License-Identifier: MIT
#include "e2lf/capture/patterns/display.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/strided_view.h"
#include "e2lf/base/text.h"

namespace e2lf::capture {
namespace {

constexpr size_t kMostDisplayPixels = size_t{1} << 28;

/// Returns a pattern [row, column] as it is oriented on the display, flipped and then turned clockwise.
StridedView<const float, 2> oriented(const Codes& codes, size_t n, const DisplayLayout& layout) {
  StridedView<const float, 2> cells(codes.pattern(n).data(), {codes.views_y, codes.views_x});
  if (layout.flip_y) cells = cells.reversed(0);
  if (layout.flip_x) cells = cells.reversed(1);
  for (unsigned turn = 0; turn < layout.quarter_turns % 4; ++turn) {
    cells = cells.reversed(0);
    std::swap(cells.extents[0], cells.extents[1]);
    std::swap(cells.strides[0], cells.strides[1]);
  }
  return cells;
}

/// Returns the first pixel of an aperture of `length` px. Fails if it does not fit on the display.
Result<size_t> begin_of(size_t display, size_t length, int64_t offset, const char* axis) {
  const auto room = static_cast<int64_t>(display) - static_cast<int64_t>(length);
  const int64_t begin = room / 2 + offset;
  if (room >= 0 && begin >= 0 && begin <= room) return static_cast<size_t>(begin);
  return fail(ErrorCode::kInvalidValue, "", "an aperture of ", length, " px with an offset of ", offset,
              " does not fit on ", display, " px in ", axis, "; use smaller cells, another offset or a larger display");
}

Result<void> check(const DisplayLayout& layout) {
  const bool sane = layout.cell_px >= 1 && layout.cell_px <= layout.width_px && layout.width_px >= 1 &&
                    layout.height_px >= 1 && layout.width_px <= kMostDisplayPixels / layout.height_px &&
                    std::abs(layout.offset_x_px) <= static_cast<int64_t>(layout.width_px) &&
                    std::abs(layout.offset_y_px) <= static_cast<int64_t>(layout.height_px);
  if (sane) return {};
  return fail(ErrorCode::kInvalidValue, "", "a display of ", layout.width_px, "x", layout.height_px,
              " px with cells of ", layout.cell_px, " px is not possible; correct the sizes and offsets");
}

}  // namespace

Result<DisplayFrame> render_pattern(const Codes& codes, size_t n, const DisplayLayout& layout) {
  E2LF_REQUIRE(n < codes.num_patterns, "there is no such pattern");
  E2LF_RETURN_IF_ERROR(check(layout));
  const StridedView<const float, 2> pattern = oriented(codes, n, layout);
  const auto [rows, columns] = pattern.extents;
  const size_t cell = layout.cell_px;
  E2LF_ASSIGN_OR_RETURN(const size_t first_x, begin_of(layout.width_px, columns * cell, layout.offset_x_px, "width"));
  E2LF_ASSIGN_OR_RETURN(const size_t first_y, begin_of(layout.height_px, rows * cell, layout.offset_y_px, "height"));
  DisplayFrame frame{layout.width_px, layout.height_px, {}};
  frame.pixels.resize(layout.width_px * layout.height_px);
  for (size_t y = 0; y < rows * cell; ++y) {
    uint8_t* row = frame.pixels.data() + (first_y + y) * layout.width_px + first_x;
    for (size_t column = 0; column < columns; ++column) {
      const auto value = static_cast<uint8_t>(std::lround(255.0F * pattern[y / cell][column]));
      std::fill_n(row + column * cell, cell, value);
    }
  }
  return frame;
}

}  // namespace e2lf::capture
