// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "e2lf/base/result.h"

namespace e2lf::capture {

/// What has changed places between the aperture's patterns and the views: a lens turns the aperture by 180 degrees
/// against the picture, a mirror swaps two sides. Disparities along a swapped axis have the wrong sign until the views
/// change places. The pictures themselves stay as they are.
struct Orientation {
  bool flip_x = false;  ///< left and right: view (r, c) belongs at (r, views_x - 1 - c)
  bool flip_y = false;  ///< top and bottom: view (r, c) belongs at (views_y - 1 - r, c)

  [[nodiscard]] bool is_upright() const { return !flip_x && !flip_y; }
  /// Both, one after the other; each is its own inverse.
  [[nodiscard]] Orientation operator+(const Orientation& other) const {
    return {flip_x != other.flip_x, flip_y != other.flip_y};
  }
  bool operator==(const Orientation&) const = default;
};

/// The grid of views is turned by 180 degrees.
inline constexpr Orientation kTurned{true, true};

/// "upright", "turned", "flipped-x", "flipped-y": the value of "views" in files of cameras and schedules, in event
/// images and in run records.
[[nodiscard]] const char* orientation_name(const Orientation& orientation);
/// Fails with kInvalidValue.
[[nodiscard]] Result<Orientation> orientation_from_name(const std::string& name, const std::string& location);

}  // namespace e2lf::capture
