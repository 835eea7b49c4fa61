// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/refocus.h"
#include "e2lf/live/live_cycle.h"

namespace e2lf::live {

/// How a light field is looked at. Viewpoints are in view steps from the middle of the grid, as those of the viewer.
struct Look {
  float x = 0.5F, y = 0.5F;  ///< viewpoint, to the right and downwards; a view of the 8x8 grid
  float focus = 0;           ///< disparity of the plane in focus, px per view step of the full size
  float radius = 0;          ///< of the round aperture, in view steps; 0 = the viewpoint alone
  std::optional<uint32_t> row = {}, column = {};  ///< px of the full size where EPIs are cut; none without
  bool operator==(const Look&) const = default;
};

/// What is sent to the browser of a light field.
struct Picture {
  lightfield::ByteImage image;
  lightfield::ByteImage row_epi, column_epi;  ///< [view_x, x] and [y, view_y]; empty where the look has no cut
};

/// Returns the weight of each view. Those of a radius of at least one view step are those of
/// lightfield::round_aperture(); smaller ones go over to the viewpoint, interpolated between its neighbours.
[[nodiscard]] lightfield::Aperture aperture_of(const lightfield::Shape& shape, const Look& look);

/// Renders the light field as `look` says, in 8 bits: round(255 * clamp(gain * (value - black))).
[[nodiscard]] Picture render(const LiveField& field, const Look& look);

/// Returns the disparity from -5 to 5, in px per view step of the full size, at which the views agree best around a
/// point (px of the full size).
[[nodiscard]] float disparity_at(const LiveField& field, float x, float y);

}  // namespace e2lf::live
