// SPDX-License-Identifier: MIT
#include "e2lf/recon/grid_shift.h"

#include <algorithm>

namespace e2lf::recon {

std::vector<GridShift> grid_shifts(size_t count, size_t size_multiple) {
  const size_t side = size_multiple;
  std::vector<GridShift> shifts;
  // Odd factors walk through every row and column of a power of two; each walk is one column beside the last.
  for (size_t i = 0; i < std::min(count, side * side); ++i) {
    shifts.push_back({5 * i % side, (3 * i + i / side) % side});
  }
  return shifts;
}

events::EventImages extend(const events::EventImages& images, const GridShift& shift) {
  events::EventImages extended(images.transitions, images.height + shift.y, images.width + shift.x);
  for (size_t transition = 0; transition < images.transitions; ++transition) {
    for (size_t y = 0; y < extended.height; ++y) {
      const auto from = images.image(transition).subspan((y - std::min(y, shift.y)) * images.width, images.width);
      const auto to = extended.image(transition).subspan(y * extended.width, extended.width);
      std::fill_n(to.begin(), shift.x, from.front());
      std::copy(from.begin(), from.end(), to.begin() + static_cast<std::ptrdiff_t>(shift.x));
    }
  }
  return extended;
}

}  // namespace e2lf::recon
