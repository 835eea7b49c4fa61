// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/light_field_io.h"

namespace e2lf::lightfield {

/// The columns of the grids of the benchmark and of those written here: number = 9 * row + column.
inline constexpr size_t kHciColumns = 9;

struct NumberedView {
  LightFieldKind kind;  ///< one of the folder kinds
  size_t row, column;   ///< in kHciFolder, whose names contain one number: row 0 and that number
};

/// Returns whether the extension of a file is that of PNG or JPEG images.
[[nodiscard]] bool is_image_name(const std::filesystem::path& file);

/// Parses the file name of a view. Returns nothing for any other file.
[[nodiscard]] std::optional<NumberedView> parse_view_name(const std::filesystem::path& file);

/// A file name with two numbers, which may be the row and the column of a view: view_0_0.png, r00_c00.png.
struct PairName {
  std::string words;  ///< the name without its numbers, which all views of a light field share: "view_#_#"
  size_t row, column;
  /// Whether the first number is the column, as in x0_y0.png.
  bool is_column_first;
};

/// Parses a file name with two numbers. The first one is the row, unless a letter x, u or c, or a word that begins with
/// col, stands in front of it. Returns nothing for any other file.
[[nodiscard]] std::optional<PairName> parse_pair_name(const std::filesystem::path& file);

/// Returns the PNG name of a view. The camera position in a Stanford name is unknown here and is given as *.
[[nodiscard]] std::string view_name(LightFieldKind kind, size_t row, size_t column);

/// Returns the name of the view with another number, with as many digits and the same extension as `like`, which is a
/// name of kHciFolder.
[[nodiscard]] std::string numbered_view_name(const std::filesystem::path& like, size_t number);

/// Returns the name under which a view is written. The camera position in a Stanford name is -row and -column, in view
/// steps.
[[nodiscard]] std::string written_view_name(LightFieldKind kind, size_t row, size_t column);

/// The grid of views that are numbered consecutively: number = first + columns * row + column.
struct FlatGrid {
  size_t first = 0, columns = 1;
  size_t rows = 0;  ///< 0 = as many as the numbers reach
};

/// Finds the grid of views with these numbers, which must be sorted and distinct, with at least one. The first of these
/// sources that applies determines it: `columns`, unless it is 0; `num_cams_x` and `num_cams_y` in parameters.cfg in
/// the folder, as in the HCI 4D benchmark; a square number of views from the first to the last number, some of which
/// may be missing; rows of numbers with equal gaps between them, such as those of 8x8 views that keep their numbers of
/// a 9x9 grid. Fails with kInvalidValue if none applies, and with kShape if parameters.cfg contradicts the numbers.
[[nodiscard]] Result<FlatGrid> find_flat_grid(const std::vector<size_t>& numbers, size_t columns,
                                              const std::filesystem::path& folder);

}  // namespace e2lf::lightfield
