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
    // The bits of i alternate between both coordinates: four shifts cover the finest grid, and sixteen the next coarser
    // one. The odd factors separate shifts that are neighbours in this order.
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

namespace {

template <typename Value>
void extend_image(std::span<const Value> from, size_t width, const GridShift& shift, std::span<Value> to) {
  const size_t wider = width + shift.x, higher = to.size() / wider;
  for (size_t y = 0; y < higher; ++y) {
    const auto from_row = from.subspan((y - std::min(y, shift.y)) * width, width);
    const auto to_row = to.subspan(y * wider, wider);
    std::fill_n(to_row.begin(), shift.x, from_row.front());
    std::copy(from_row.begin(), from_row.end(), to_row.begin() + static_cast<std::ptrdiff_t>(shift.x));
  }
}

}  // namespace

capture::Measurement extend(const capture::Measurement& measurement, const GridShift& shift) {
  const capture::EventImages& events = measurement.events;
  const capture::CodedIntensities& images = measurement.images;
  E2LF_REQUIRE(measurement.height() > 0 && measurement.width() > 0, "images must not be empty");
  E2LF_REQUIRE(measurement.kind != capture::MeasurementKind::kLensArray || shift == GridShift(),
               "lenses cannot be shifted");
  capture::Measurement extended;
  extended.kind = measurement.kind;
  if (events.count > 0) {
    extended.events = capture::EventImages(events.count, events.height + shift.y, events.width + shift.x);
  }
  if (images.count > 0) {
    extended.images = capture::CodedIntensities(images.count, images.height + shift.y, images.width + shift.x);
  }
  for (size_t k = 0; k < events.count; ++k) {
    extend_image(events.image(k), events.width, shift, extended.events.image(k));
  }
  for (size_t n = 0; n < images.count; ++n) {
    extend_image(images.image(n), images.width, shift, extended.images.image(n));
  }
  return extended;
}

}  // namespace e2lf::recon
