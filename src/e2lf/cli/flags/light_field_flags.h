// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "e2lf/capture/profile/orientation.h"
#include "e2lf/lightfield/light_field_io.h"

namespace e2lf::cli {

/// The help group of the options of light fields.
inline constexpr const char* kLightFieldOptions = "Light fields";

/// The flags that let views change places.
struct OrientationFlags {
  bool turn_views = false, flip_x = false, flip_y = false;

  /// All that are given, one after the other.
  [[nodiscard]] capture::Orientation value() const {
    return capture::Orientation{flip_x, flip_y} + (turn_views ? capture::kTurned : capture::Orientation{});
  }
  /// How views come out that `recorded` tells of, or nothing; nothing where neither tells.
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
  size_t views = 8, step = 1;  ///< per axis; views 0 = all
  float white = 0.0F;          ///< the stored number that is 1; 0 = as the type says
  size_t view_columns = 0;     ///< of views that are numbered one by one; 0 = found
  size_t lenslet_views = 0;    ///< per axis of a lenslet mosaic; 0 = as it says
  OrientationFlags orientation = {};
};

/// Declares --step, --white, --view-columns and --lenslet-views, and --views where the verb can use any number of them.
void add_light_field_options(CLI::App& app, LightFieldFlags& flags, bool has_views);

[[nodiscard]] lightfield::ReadOptions read_options(const LightFieldFlags& flags);

}  // namespace e2lf::cli
