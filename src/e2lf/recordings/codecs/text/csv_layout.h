// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <span>
#include <string>

#include "e2lf/recordings/codecs/text/csv_line.h"
#include "e2lf/recordings/table/layout.h"

namespace e2lf::recordings::text {

/// The first lines of a text, before it is decided what they mean.
struct TextHead {
  bool has_decimal_comma = false;
  bool has_six_decimals = false;  ///< in the first column, as where it is seconds
  char line_end = '\n';           ///< '\r' of old Macs
  size_t columns = 0;             ///< of most lines; 0 = there is no line of numbers
  size_t width = 0, height = 0;
  size_t header_bytes = 0;  ///< where the events begin
  std::string names_line;   ///< the line of names, which may come again; empty = none
  table::TableSample sample;
  size_t lines = 0, bad_lines = 0;  ///< of numbers, and of those that have not as many as most
  size_t first_bad_number = 0;      ///< counted from 1; where no line has numbers, of one that names no columns either
  std::string first_bad;
};

/// Looks at the first lines. `is_whole` says that there are no more. Fails with kUnsupported for UTF-16.
[[nodiscard]] Result<TextHead> read_head(std::span<const uint8_t> bytes, bool is_whole, const std::string& location);

/// For messages: at most 60 characters, none of them a control character.
[[nodiscard]] std::string quoted(std::string_view line);

}  // namespace e2lf::recordings::text
