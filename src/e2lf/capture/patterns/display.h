// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/patterns/codes.h"

namespace e2lf::capture {

/// Where the aperture lies on a display. The defaults are the paper's: an SXGA display, its central 800x800 px.
struct DisplayLayout {
  size_t width_px = 1280, height_px = 1024;
  size_t cell_px = 100;                      ///< side of a cell
  int64_t offset_x_px = 0, offset_y_px = 0;  ///< of the aperture from the display's centre, right and down
  unsigned quarter_turns = 0;                ///< the patterns are turned so often by 90 degrees, clockwise
  bool flip_x = false, flip_y = false;       ///< before that: left and right, top and bottom change places
};

/// One picture for the display: [y, x], row-major, 0 = closed, 255 = open; outside the aperture closed.
struct DisplayFrame {
  size_t width_px = 0, height_px = 0;
  std::vector<uint8_t> pixels;
};

/// Pattern n of `codes` as the display shows it; transmittances become round(255 * value). Fails with kInvalidValue
/// when the aperture does not fit on the display.
[[nodiscard]] Result<DisplayFrame> render_pattern(const Codes& codes, size_t n, const DisplayLayout& layout);

}  // namespace e2lf::capture
