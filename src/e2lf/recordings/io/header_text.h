// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace e2lf::recordings {

/// Returns a text without blanks at its begin and end.
[[nodiscard]] std::string_view trimmed(std::string_view text, std::string_view blanks = " \t");

/// Returns a text without the byte order mark with which some programs begin UTF-8.
[[nodiscard]] std::string_view without_mark(std::string_view text);

/// Returns text of a file or a device, such as the value of a header key, as one line of UTF-8 that is safe to print:
/// bytes that are not UTF-8 are read as Latin-1, and control characters, which could command a terminal, become spaces.
[[nodiscard]] std::string header_text(std::string_view bytes);

/// Parses a size of 1 to `most`, or two of them as in "1280x720"; returns nothing for any other text.
[[nodiscard]] std::optional<size_t> parse_side(std::string_view text, size_t most);
[[nodiscard]] std::optional<std::pair<size_t, size_t>> parse_geometry(std::string_view text, size_t most);

/// The lines that begin with "%" at the start of Prophesee's RAW and DAT files.
struct PercentHeader {
  std::vector<std::pair<std::string, std::string>> keys;  ///< keys and values of the lines "% key value"
  size_t num_bytes = 0;                                   ///< offset of the data
};

/// Returns whether a character may be in a key.
[[nodiscard]] bool is_key_character(char c);

/// Whether the data after a header may begin with "%": events of RAW may, but not the type of the records of DAT.
enum class DataBegin { kMayBePercent, kIsNoPercent };

/// Parses the header at the start of `text`: all lines of text that begin with "%" up to the line "% end". If there is
/// no such line, it has those of the form "% key value", or, if the data cannot begin with "%", all lines that do. A
/// missing header is an empty one. If not `ended`, more text may follow, and nothing is returned to request it.
[[nodiscard]] std::optional<PercentHeader> parse_percent_header(std::string_view text, bool ended,
                                                                DataBegin data = DataBegin::kMayBePercent);

}  // namespace e2lf::recordings
