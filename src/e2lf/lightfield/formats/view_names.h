// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "e2lf/lightfield/light_field_io.h"

namespace e2lf::lightfield {

/// The columns of the benchmark's own grids, and of those that are written: number = 9 * row + column.
inline constexpr size_t kHciColumns = 9;

struct NumberedView {
  LightFieldKind kind;  ///< one of the folder kinds
  size_t row, column;   ///< of kHciFolder, whose names hold one number, row 0 and that number
};

/// What the name of a view's image file says; absent for any other file.
[[nodiscard]] std::optional<NumberedView> parse_view_name(const std::filesystem::path& file);

/// The PNG name of a view; the camera position in a Stanford name is not known here and stands as *.
[[nodiscard]] std::string view_name(LightFieldKind kind, size_t row, size_t column);

/// The name of the view with another number, after that of one of kHciFolder: as many digits, the same extension.
[[nodiscard]] std::string numbered_view_name(const std::filesystem::path& like, size_t number);

/// The same to write a view: the camera position is -row and -column, in view steps.
[[nodiscard]] std::string written_view_name(LightFieldKind kind, size_t row, size_t column);

}  // namespace e2lf::lightfield
