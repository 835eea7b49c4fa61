// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "e2lf/base/result.h"

namespace e2lf::capture {

/// How the grid of views is oriented relative to the aperture patterns. A lens turns the aperture by 180 degrees
/// against the image, and a mirror flips one axis. Disparities along a flipped axis have the wrong sign until the views
/// are reordered. The images themselves are unchanged.
struct Orientation {
  bool flip_x = false;  ///< view (r, c) belongs at (r, views_x - 1 - c)
  bool flip_y = false;  ///< view (r, c) belongs at (views_y - 1 - r, c)

  [[nodiscard]] bool is_upright() const { return !flip_x && !flip_y; }
  /// Returns the combination of two orientations. Each orientation is its own inverse.
  [[nodiscard]] Orientation operator+(const Orientation& other) const {
    return {flip_x != other.flip_x, flip_y != other.flip_y};
  }
  bool operator==(const Orientation&) const = default;
};

/// The grid of views is turned by 180 degrees.
inline constexpr Orientation kTurned{true, true};

/// Returns "upright", "turned", "flipped-x" or "flipped-y": the value of "views" in camera files, schedule files, event
/// images and run records.
[[nodiscard]] const char* orientation_name(const Orientation& orientation);
/// Parses such a name. Fails with kInvalidValue.
[[nodiscard]] Result<Orientation> orientation_from_name(const std::string& name, const std::string& location);

}  // namespace e2lf::capture
