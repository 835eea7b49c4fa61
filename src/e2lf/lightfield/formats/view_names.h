// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "e2lf/lightfield/light_field_io.h"

namespace e2lf::lightfield {

/// HCI numbers its views 9 * row + column.
inline constexpr size_t kHciColumns = 9;

struct NumberedView {
  LightFieldKind kind;  ///< one of the folder kinds
  size_t row, column;
};

/// What the name of a view's image file says; absent for any other file.
[[nodiscard]] std::optional<NumberedView> parse_view_name(const std::filesystem::path& file);

/// The PNG name of a view; the camera position in a Stanford name is not known here and stands as *.
[[nodiscard]] std::string view_name(LightFieldKind kind, size_t row, size_t column);

/// The same to write a view: the camera position is -row and -column, in view steps.
[[nodiscard]] std::string written_view_name(LightFieldKind kind, size_t row, size_t column);

}  // namespace e2lf::lightfield
