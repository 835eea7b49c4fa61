// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "e2lf/recordings/event.h"
#include "e2lf/recordings/recording.h"
#include "e2lf/recordings/table/field.h"
#include "e2lf/recordings/table/polarity.h"

namespace e2lf::recordings::text {

/// How a line of text is to be read as an event.
struct LineLayout {
  std::vector<std::optional<table::Field>> columns;  ///< nothing: passed over
  TimeUnit unit = TimeUnit::kMicroseconds;
  table::PolarityCode polarity;
  bool has_decimal_comma = false;
};

/// Between two numbers: commas (unless they are decimal), semicolons, bars, blanks, quotes, in any number.
[[nodiscard]] bool is_separator(char c, bool has_decimal_comma);

/// Whether a line is a comment, which begins with #, %, // or ;.
[[nodiscard]] bool is_comment(std::string_view line);

/// The words between separators.
[[nodiscard]] std::vector<std::string_view> split(std::string_view line, bool has_decimal_comma);

/// A number, or a polarity in words (true, ON, +); nothing for other words.
[[nodiscard]] std::optional<double> parse_cell(std::string_view word, bool has_decimal_comma);

/// Reads one line, without its end, as an event. Times are exact to the microsecond: whole nanoseconds are rounded
/// down, all others to the nearest. False when it is not one.
[[nodiscard]] bool parse_line(std::string_view line, const LineLayout& layout, Event& event);

}  // namespace e2lf::recordings::text
