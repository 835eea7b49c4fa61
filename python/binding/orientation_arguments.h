// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "e2lf/lightfield/crop.h"
#include "python/binding/arrays.h"

/// The arguments of every function that can reorder the views; see open_arguments.h.
#define E2LF_ORIENTATION_PARAMETERS bool turn_views, bool flip_x, bool flip_y
#define E2LF_ORIENTATION_VALUE ::e2lf::python::orientation_of(turn_views, flip_x, flip_y)
#define E2LF_ORIENTATION_ARGUMENTS py::arg("turn_views") = false, py::arg("flip_x") = false, py::arg("flip_y") = false
#define E2LF_ORIENTATION_DOC                                                                                       \
  "turn_views, flip_x, flip_y: turn the grid of views by 180 degrees, exchange left and right views, or exchange " \
  "upper and lower views, which changes the sign of disparities.\n"

namespace e2lf::python {

/// Returns the combination of all arguments that are set.
inline capture::Orientation orientation_of(bool turn_views, bool flip_x, bool flip_y) {
  return capture::Orientation{flip_x, flip_y} + (turn_views ? capture::kTurned : capture::Orientation{});
}

/// Returns the light field with its views reordered.
inline Borrowed<lightfield::LightField> oriented(Borrowed<lightfield::LightField> field,
                                                 const capture::Orientation& orientation) {
  if (orientation.is_upright()) return field;
  lightfield::LightField copy = *field;
  lightfield::orient(copy, orientation);
  return Borrowed<lightfield::LightField>(std::move(copy));
}

/// Returns the name of an orientation, e.g. "turned", or nothing.
inline std::optional<std::string> orientation_word(const std::optional<capture::Orientation>& views) {
  return views ? std::optional<std::string>(capture::orientation_name(*views)) : std::nullopt;
}

inline constexpr const char* kViewsDoc =
    "Orientation of the views: \"upright\", \"turned\", \"flipped-x\", \"flipped-y\"; None if it is unknown.";

}  // namespace e2lf::python
