// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/refocus.h"
#include "e2lf/live/live_cycle.h"

namespace e2lf::live {

/// The images of a light field that are sent to the browser.
struct Picture {
  lightfield::ByteImage image;
  lightfield::ByteImage row_epi, column_epi;  ///< [view_x, x] and [y, view_y]; empty if not requested
};

/// Returns the numbers of the views that render() needs, in order; empty = all.
[[nodiscard]] std::vector<size_t> views_of(const lightfield::Shape& shape, const RenderSettings& settings);

/// Returns whether a light field contains these views, given as by views_of().
[[nodiscard]] bool has_views(const LiveField& field, const std::vector<size_t>& views);

/// Renders the light field with the parameters `settings` to 8 bits: round(255 * clamp(gain * (value - black))).
[[nodiscard]] Picture render(const LiveField& field, const RenderSettings& settings);

/// Returns the disparity from -5 to 5, in px per view step of the full size, at which the views agree best around a
/// point (px of the full size).
[[nodiscard]] float disparity_at(const LiveField& field, float x, float y);

}  // namespace e2lf::live
