// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "e2lf/formats/table/table.h"
#include "e2lf/recordings/event.h"

namespace e2lf::formats::text {

/// The layout of a text, and the meaning of the columns in a line of it.
struct TextLayout {
  std::vector<std::optional<table::Field>> columns;  ///< empty = the column is skipped
  TimeUnit unit = TimeUnit::kMicroseconds;
  table::PolarityCode polarity;
  size_t header_bytes = 0;
  std::string header_line;  ///< may be repeated where files were concatenated
};

/// Returns true if a line is a comment, that is, begins with #, %, // or ;.
[[nodiscard]] bool is_comment(std::string_view line);

/// Parses one line, without its line ending, as an event. Times are rounded to microseconds: integral nanoseconds
/// downwards, all others to the nearest. Returns false if the line is not an event.
[[nodiscard]] bool parse_line(std::string_view line, const TextLayout& layout, Event& event);

/// The content of the first lines of a text, before their meaning is determined.
struct TextHead {
  table::TableSample sample;        ///< without columns if there are no lines of numbers
  size_t width = 0, height = 0;     ///< of the sensor, px; 0 = not stated
  size_t header_bytes = 0;          ///< offset of the events
  std::string header_line;          ///< the last line of the header, which may be repeated; empty = none
  size_t lines = 0, bad_lines = 0;  ///< number of lines of numbers, and of those with another number of columns
  size_t first_bad_number =
      0;  ///< number of the first bad line, from 1; without lines of numbers, the first line that does not name columns
  std::string first_bad;
};

/// Analyses the first lines. `is_whole` states that no further lines follow. Fails with kUnsupported for UTF-16.
[[nodiscard]] Result<TextHead> read_head(std::span<const uint8_t> bytes, bool is_whole, const std::string& location);

/// Returns a line for messages: at most 60 characters and without control characters.
[[nodiscard]] std::string quoted(std::string_view line);

}  // namespace e2lf::formats::text
