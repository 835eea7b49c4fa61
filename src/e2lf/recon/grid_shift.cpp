// SPDX-License-Identifier: MIT
#include "e2lf/recon/grid_shift.h"

#include <algorithm>
#include <bit>

#include "e2lf/base/contract.h"

namespace e2lf::recon {

std::vector<GridShift> grid_shifts(size_t count, size_t size_multiple) {
  const size_t side = std::bit_ceil(size_multiple);
  std::vector<GridShift> shifts;
  for (size_t i = 0; i < side * side && shifts.size() < count; ++i) {
    // The bits of i go to both coordinates in turn: four shifts differ in every way on the finest grid, sixteen on the
    // next. The odd factors keep neighbours in this order apart.
    size_t y = 0, both = 0;
    for (size_t bit = 0; (size_t{1} << bit) < side; ++bit) {
      y |= (i >> (2 * bit) & 1U) << bit;
      both |= (i >> (2 * bit + 1) & 1U) << bit;
    }
    const GridShift shift{3 * y % side, 5 * (both ^ y) % side};
    if (std::max(shift.y, shift.x) < size_multiple) shifts.push_back(shift);
  }
  return shifts;
}

capture::EventImages extend(const capture::EventImages& images, const GridShift& shift) {
  E2LF_REQUIRE(images.image_size() > 0, "event images must not be empty");
  capture::EventImages extended(images.transitions, images.height + shift.y, images.width + shift.x);
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
