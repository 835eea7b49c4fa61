// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/npy.h"
#include "e2lf/files/options.h"

namespace e2lf::capture {

/// Aperture patterns in the order in which they are shown: float32 [N, view_y, view_x], row-major, transmittances in
/// [0, 1].
struct Codes {
  size_t num_patterns = 0, views_y = 0, views_x = 0;
  std::vector<float> values;

  Codes() = default;
  Codes(size_t num_patterns_, size_t views_y_, size_t views_x_)
      : num_patterns(num_patterns_),
        views_y(views_y_),
        views_x(views_x_),
        values(num_patterns_ * views_y_ * views_x_) {}

  [[nodiscard]] size_t pattern_size() const { return views_y * views_x; }
  [[nodiscard]] std::span<float> pattern(size_t n) {
    return std::span(values).subspan(n * pattern_size(), pattern_size());
  }
  [[nodiscard]] std::span<const float> pattern(size_t n) const {
    return std::span(values).subspan(n * pattern_size(), pattern_size());
  }
  bool operator==(const Codes&) const = default;
};

/// Checks that there is at least one pattern and that all transmittances are in [0, 1]. Fails with kShape (no patterns,
/// or a wrong number of `values`) and kInvalidValue (NaN or out of range), naming the pattern and the cell. `location`
/// is the file in the errors.
[[nodiscard]] Result<void> validate(const Codes& codes, const std::string& location);

/// Returns whether all cells of the first pattern are closed, so that the first events measure absolute intensity.
[[nodiscard]] bool is_black_first(const Codes& codes);

/// Returns whether every transmittance is 0 or 1, as an aperture with shutters requires.
[[nodiscard]] bool is_binary(const Codes& codes);

/// Computes the mean transmittance of each pattern, in [0, 1]: the fraction of the light of the open aperture that
/// reaches the sensor.
[[nodiscard]] std::vector<float> light_efficiency(const Codes& codes);

/// Computes the inverse patterns, 1 - transmittance: a pattern and its inverse add up to the open aperture.
[[nodiscard]] Codes complement(const Codes& codes);

/// Appends a pattern with all cells open.
[[nodiscard]] Codes with_open_aperture(const Codes& codes);

/// Returns four binary patterns of 8x8 cells for demos and tests. The first is black; the others are discs of 12 cells
/// in the lower left, lower right and upper right quarter. Discs of equal size make parallax the only change between
/// them, along x in one transition and along y in the next, over a baseline of four views. Compact discs keep each
/// coded image sharp.
[[nodiscard]] Codes default_codes();

/// Returns the patterns that a display shows in a whole cycle, [2N + 1, view_y, view_x]: a_1 to a_N, the inverses of
/// a_1 to a_N, and a_1 again. They have 2N transitions.
[[nodiscard]] Codes whole_cycle(const Codes& codes);

/// Returns the patterns a_1 to a_N from which whole_cycle() made `codes`, for N of at least 2; nothing if `codes` do
/// not have this form.
[[nodiscard]] std::optional<Codes> codes_of_whole_cycle(const Codes& codes);

/// Lines of a recording's header, each a key and its value.
using HeaderLines = std::vector<std::pair<std::string, std::string>>;

/// Formats the patterns as header lines "e2lf_pattern_1 00000000/00111000/...", one per pattern, numbered from 1. Rows
/// are separated by "/". A row of a binary pattern consists of digits 0 and 1, a row of any other pattern of numbers
/// separated by ",".
[[nodiscard]] HeaderLines codes_to_header(const Codes& codes);

/// Reads the patterns from the lines of a header, which may be in any order and among other lines. Returns nothing if
/// there are none. Fails with kFormat (a missing pattern, or a malformed row) and as codes_from_json() does.
[[nodiscard]] Result<std::optional<Codes>> codes_from_header(const HeaderLines& header, const std::string& location);

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
