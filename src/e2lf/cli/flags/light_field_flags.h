// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "e2lf/capture/profile/orientation.h"
#include "e2lf/lightfield/light_field_io.h"

namespace e2lf::cli {

/// The help group of the options of light fields.
inline constexpr const char* kLightFieldOptions = "Light fields";

/// The flags that change the orientation of the views.
struct OrientationFlags {
  bool turn_views = false, flip_x = false, flip_y = false;

  /// Returns the combination of all flags that are set.
  [[nodiscard]] capture::Orientation value() const {
    return capture::Orientation{flip_x, flip_y} + (turn_views ? capture::kTurned : capture::Orientation{});
  }
  /// Returns the orientation that results from `recorded` and the flags, or nothing if neither is set.
  [[nodiscard]] std::optional<capture::Orientation> after(const std::optional<capture::Orientation>& recorded) const {
    if (value().is_upright()) return recorded;
    return recorded.value_or(capture::Orientation{}) + value();
  }
};

/// The help group of these options.
inline constexpr const char* kOrientationOptions = "Orientation of the views";

/// Declares --turn-views, --flip-x and --flip-y.
void add_orientation_options(CLI::App& app, OrientationFlags& flags);

/// The flags of verbs that read a light field.
struct LightFieldFlags {
  size_t views = 8, step = 1;  ///< number of views per axis (0 = all), and the step between them
  float white = 0.0F;          ///< stored value that corresponds to 1; 0 = the largest of the type
  size_t view_columns = 0;     ///< number of columns of the grid if views are numbered consecutively; 0 = detected
  size_t lenslet_views = 0;    ///< views per axis of a lenslet mosaic; 0 = as its name states
  OrientationFlags orientation = {};
};

/// Declares --step, --white, --view-columns and --lenslet-views, and also --views if the verb can use any number of
/// views.
void add_light_field_options(CLI::App& app, LightFieldFlags& flags, bool has_views);

[[nodiscard]] lightfield::ReadOptions read_options(const LightFieldFlags& flags);

}  // namespace e2lf::cli
