// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/patterns/codes.h"

namespace e2lf::capture {

/// Position and orientation of the aperture on a display. By default it occupies the central 800x800 px of an SXGA
/// display, as in the paper.
struct DisplayLayout {
  size_t width_px = 1280, height_px = 1024;
  size_t cell_px = 100;  ///< width and height of a cell
  int64_t offset_x_px = 0,
          offset_y_px = 0;     ///< position of the aperture's centre relative to that of the display, right and down
  unsigned quarter_turns = 0;  ///< number of clockwise turns of the patterns by 90 degrees
  bool flip_x = false, flip_y = false;  ///< mirrors the patterns left to right and top to bottom, before the turns
};

/// One image for the display: [y, x], row-major, 0 = closed, 255 = open. Pixels outside the aperture are closed.
struct DisplayFrame {
  size_t width_px = 0, height_px = 0;
  std::vector<uint8_t> pixels;
};

/// Renders pattern n of `codes` for the display; a transmittance becomes round(255 * value). Fails with kInvalidValue
/// if the aperture does not fit on the display.
[[nodiscard]] Result<DisplayFrame> render_pattern(const Codes& codes, size_t n, const DisplayLayout& layout);

}  // namespace e2lf::capture
