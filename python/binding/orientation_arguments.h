// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "e2lf/cli/flags/light_field_flags.h"
#include "e2lf/lightfield/orient.h"
#include "python/binding/arrays.h"

/// The arguments of every function that lets views change places: see open_arguments.h.
#define E2LF_ORIENTATION_PARAMETERS bool turn_views, bool flip_x, bool flip_y
#define E2LF_ORIENTATION_VALUE ::e2lf::cli::OrientationFlags{turn_views, flip_x, flip_y}.value()
#define E2LF_ORIENTATION_ARGUMENTS py::arg("turn_views") = false, py::arg("flip_x") = false, py::arg("flip_y") = false
#define E2LF_ORIENTATION_DOC                                                                                         \
  "turn_views, flip_x, flip_y: the grid of views is turned by 180 degrees, left and right views or upper and lower " \
  "ones change places: disparities change their sign.\n"

namespace e2lf::python {

/// The light field with its views in their places.
inline Borrowed<lightfield::LightField> oriented(Borrowed<lightfield::LightField> field,
                                                 const capture::Orientation& orientation) {
  if (orientation.is_upright()) return field;
  lightfield::LightField copy = *field;
  lightfield::orient(copy, orientation);
  return Borrowed<lightfield::LightField>(std::move(copy));
}

/// "turned" and the like, or nothing.
inline std::optional<std::string> orientation_word(const std::optional<capture::Orientation>& views) {
  return views ? std::optional<std::string>(capture::orientation_name(*views)) : std::nullopt;
}

inline constexpr const char* kViewsDoc =
    "How the views come out: \"upright\", \"turned\", \"flipped-x\", \"flipped-y\"; None where nothing tells.";

}  // namespace e2lf::python
