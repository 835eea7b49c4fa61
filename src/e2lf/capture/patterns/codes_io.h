// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "e2lf/capture/patterns/codes.h"
#include "e2lf/files/npy.h"
#include "e2lf/files/options.h"

namespace e2lf::capture {

/// Reads patterns from `{"patterns": [[row, ...], ...]}`, where each row is a list of numbers or a string of digits 0
/// and 1 ("01100110"). Fails with kShape (rows or patterns of different sizes), kFormat and kInvalidValue; the errors
/// contain the JSON path after `location`.
[[nodiscard]] Result<Codes> codes_from_json(const Json& json, const std::string& location);

/// Returns patterns as such an object, with strings for the rows of binary patterns and lists of numbers for all
/// others.
[[nodiscard]] Json codes_to_json(const Codes& codes);

/// Reads patterns from a numeric array [N, view_y, view_x]. Fails with kShape (another rank) and as validate() does.
[[nodiscard]] Result<Codes> codes_from_npy(const NpyArray& array, const std::string& location);

/// Returns patterns as an array float32 [N, view_y, view_x].
[[nodiscard]] NpyArray codes_to_npy(const Codes& codes);

/// Reads or writes patterns in the format of the file's extension: .json, .npy, or .npz with an array `codes`. Fails
/// with kUnsupported for other extensions. (The patterns of model files are read by model::read_model.)
[[nodiscard]] Result<Codes> read_codes(const std::filesystem::path& path);
[[nodiscard]] Result<void> write_codes(const std::filesystem::path& path, const Codes& codes);

/// Draws the patterns with characters for a terminal, four side by side, each below its number and light efficiency:
/// "#" is an open cell, "." a closed one, and ":-=+*" are the steps between.
[[nodiscard]] std::string codes_text(const Codes& codes);

}  // namespace e2lf::capture
