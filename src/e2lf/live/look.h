// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/refocus.h"
#include "e2lf/live/live_cycle.h"

namespace e2lf::live {

/// What is sent to the browser of a light field.
struct Picture {
  lightfield::ByteImage image;
  lightfield::ByteImage row_epi, column_epi;  ///< [view_x, x] and [y, view_y]; empty where the look has no cut
};

/// Returns the weight of each view. Those of a radius of at least one view step are those of
/// lightfield::round_aperture(); smaller ones go over to the viewpoint, interpolated between its neighbours.
[[nodiscard]] lightfield::Aperture aperture_of(const lightfield::Shape& shape, const Look& look);

/// Returns the numbers of the views that render() needs, in order; none = all.
[[nodiscard]] std::vector<size_t> views_of(const lightfield::Shape& shape, const Look& look);

/// Returns whether a light field has these views, as views_of() returns them.
[[nodiscard]] bool has_views(const LiveField& field, const std::vector<size_t>& views);

/// Renders the light field as `look` says, in 8 bits: round(255 * clamp(gain * (value - black))).
[[nodiscard]] Picture render(const LiveField& field, const Look& look);

}  // namespace e2lf::live
