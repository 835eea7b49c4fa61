// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "e2lf/recordings/event.h"
#include "e2lf/recordings/recording.h"
#include "e2lf/recordings/table/column_names.h"
#include "e2lf/recordings/table/polarity.h"

namespace e2lf::recordings::text {

/// The meaning of the columns in a line of text.
struct LineLayout {
  std::vector<std::optional<table::Field>> columns;  ///< empty = the column is skipped
  TimeUnit unit = TimeUnit::kMicroseconds;
  table::PolarityCode polarity;
  bool has_decimal_comma = false;
};

/// Returns true for characters between two numbers: commas (unless they are decimal), semicolons, bars, blanks and
/// quotes.
[[nodiscard]] bool is_separator(char c, bool has_decimal_comma);

/// Returns true if a line is a comment, that is, begins with #, %, // or ;.
[[nodiscard]] bool is_comment(std::string_view line);

/// Returns the words between separators.
[[nodiscard]] std::vector<std::string_view> split(std::string_view line, bool has_decimal_comma);

/// Parses a number, or a polarity in words (true, ON, +). Returns nothing for other words.
[[nodiscard]] std::optional<double> parse_cell(std::string_view word, bool has_decimal_comma);

/// Parses one line, without its line ending, as an event. Times are rounded to microseconds: integral nanoseconds
/// downwards, all others to the nearest. Returns false if the line is not an event.
[[nodiscard]] bool parse_line(std::string_view line, const LineLayout& layout, Event& event);

}  // namespace e2lf::recordings::text
