// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "e2lf/capture/patterns/codes.h"
#include "e2lf/files/npy.h"
#include "e2lf/files/options.h"

namespace e2lf::capture {

/// Patterns from `{"patterns": [[row, ...], ...]}`; a row is a list of numbers or a text of 0 and 1 ("01100110").
/// Fails with kShape (rows or patterns of different sizes), kFormat and kInvalidValue, with the JSON path in
/// `location`.
[[nodiscard]] Result<Codes> codes_from_json(const Json& json, const std::string& location);

/// The same object; binary patterns as text rows, others as numbers.
[[nodiscard]] Json codes_to_json(const Codes& codes);

/// Patterns from a numeric array [N, view_y, view_x]. Fails with kShape for another rank and as validate() does.
[[nodiscard]] Result<Codes> codes_from_npy(const NpyArray& array, const std::string& location);

/// The same as an array float32 [N, view_y, view_x].
[[nodiscard]] NpyArray codes_to_npy(const Codes& codes);

/// Reads / writes patterns by the file's extension: .json, .npy, or .npz with an array `codes`. Fails with kUnsupported
/// for another extension. (Model files hold patterns too: see model::read_model.)
[[nodiscard]] Result<Codes> read_codes(const std::filesystem::path& path);
[[nodiscard]] Result<void> write_codes(const std::filesystem::path& path, const Codes& codes);

/// The patterns as a picture of characters for a terminal, four side by side, each under its number and light
/// efficiency: "#" = open, "." = closed, ":-=+*" between.
[[nodiscard]] std::string codes_text(const Codes& codes);

}  // namespace e2lf::capture
