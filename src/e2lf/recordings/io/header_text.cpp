// SPDX-License-Identifier: MIT
#include "e2lf/recordings/io/header_text.h"

#include <algorithm>
#include <cstddef>

#include "e2lf/base/text.h"

namespace e2lf::recordings {
namespace {

constexpr size_t kMaxHeader = size_t{1} << 20;  ///< bytes of a header, and of a line of it

bool is_beyond_ascii(char c) {
  return static_cast<uint8_t>(c) >= 0x80;
}

/// Returns whether a line begins with "%" and is text.
bool is_percent_text(std::string_view line) {
  const auto is_text = [](char c) { return static_cast<uint8_t>(c) >= ' ' ? c != 0x7F : c == '\t' || c == '\r'; };
  return line.starts_with('%') && std::all_of(line.begin(), line.end(), is_text);
}

/// Returns whether a line has the form "% key value". Beyond ASCII, nearly everything is a letter in some encoding, so
/// at least the key must look like one, which excludes data.
bool is_key_line(std::string_view line) {
  if (!line.starts_with("% ") || !is_percent_text(line)) return false;
  line.remove_prefix(2);
  if (!line.empty() && !is_key_character(line.front())) return false;
  if (std::none_of(line.begin(), line.end(), is_beyond_ascii)) return true;
  const std::string_view key = line.substr(0, line.find_first_of(" \t"));
  return key.size() < line.size() && std::all_of(key.begin(), key.end(), is_key_character);
}

/// Returns a line without "%" and blanks.
std::string_view content_of(std::string_view line) {
  return trimmed(line, "% \t\r");
}

/// Returns the offset after a line at `begin`, or npos if it is not complete.
size_t line_end(std::string_view text, size_t begin) {
  const size_t newline = text.substr(begin, kMaxHeader).find('\n');
  return newline == std::string_view::npos ? newline : begin + newline + 1;
}

/// Returns the offset after the lines at the start that satisfy `is_header`, up to and including one with "end" if
/// `until_end`. Returns nothing if more text is needed, and 0 if `until_end` and there is no such line.
template <typename IsHeader>
std::optional<size_t> header_bytes(std::string_view text, bool ended, bool until_end, const IsHeader& is_header) {
  for (size_t begin = 0;;) {
    const size_t end = line_end(text, begin);
    const bool is_whole = end != std::string_view::npos;
    const std::string_view line = text.substr(begin, (is_whole ? end : begin + kMaxHeader) - begin);
    const size_t so_far = until_end ? 0 : begin;
    if (!is_whole) {
      const bool may_go_on = line.empty() || (line.front() == '%' && (line.size() == 1 || is_header(line)));
      const bool needs_more = may_go_on && !ended && line.size() < kMaxHeader;
      return needs_more ? std::nullopt : std::optional(so_far);
    }
    const std::string_view without_newline = line.substr(0, line.size() - 1);
    if (!is_header(without_newline) || begin > kMaxHeader) return so_far;
    begin = end;
    if (content_of(without_newline) == "end") return begin;
  }
}

}  // namespace

std::string_view trimmed(std::string_view text, std::string_view blanks) {
  text.remove_prefix(std::min(text.size(), text.find_first_not_of(blanks)));
  return text.substr(0, text.find_last_not_of(blanks) + 1);
}

std::string_view without_mark(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  return text.starts_with(kByteOrderMark) ? text.substr(kByteOrderMark.size()) : text;
}

bool is_key_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
}

std::optional<PercentHeader> parse_percent_header(std::string_view text, bool ended, DataBegin data) {
  const auto begins_with_percent = [](std::string_view line) { return line.starts_with('%'); };
  auto bytes = data == DataBegin::kIsNoPercent ? header_bytes(text, ended, /*until_end=*/false, begins_with_percent)
                                               : header_bytes(text, ended, /*until_end=*/true, is_percent_text);
  if (bytes == size_t{0}) bytes = header_bytes(text, ended, /*until_end=*/false, is_key_line);
  if (!bytes) return std::nullopt;
  PercentHeader header;
  header.num_bytes = *bytes;
  for (std::string_view rest = text.substr(0, *bytes); !rest.empty(); rest.remove_prefix(rest.find('\n') + 1)) {
    const std::string_view line = content_of(rest.substr(0, rest.find('\n')));
    const std::string_view key = line.substr(0, line.find_first_of(" \t"));
    const bool is_comment = key.empty() || (!is_key_character(key.front()) && !is_beyond_ascii(key.front()));
    if (is_comment || line == "end") continue;
    header.keys.emplace_back(header_text(key), header_text(trimmed(line.substr(key.size()))));
  }
  return header;
}

std::optional<size_t> parse_side(std::string_view text, size_t most) {
  const auto value = parse_number<size_t>(text);
  return value && *value >= 1 && *value <= most ? value : std::nullopt;
}

std::optional<std::pair<size_t, size_t>> parse_geometry(std::string_view text, size_t most) {
  const size_t cross = std::min(text.find('x'), text.size());
  const auto width = parse_side(text.substr(0, cross), most);
  const auto height = parse_side(text.substr(std::min(cross + 1, text.size())), most);
  return width && height ? std::optional(std::pair(*width, *height)) : std::nullopt;
}

std::string header_text(std::string_view bytes) {
  const bool is_text = is_utf8(bytes);
  std::string text;
  for (const char character : bytes) {
    const auto byte = static_cast<uint8_t>(character);
    // In UTF-8, the control characters from 0x80 to 0x9F follow 0xC2.
    const bool is_high = byte >= 0x80 && byte < 0xA0 && (!is_text || text.ends_with('\xC2'));
    if (is_high && is_text) text.pop_back();
    if (byte < ' ' || byte == 0x7F || is_high) {
      text += ' ';
    } else if (is_text || byte < 0x80) {
      text += character;
    } else {
      text += static_cast<char>(0xC0 | byte >> 6);
      text += static_cast<char>(0x80 | (byte & 0x3F));
    }
  }
  return text;
}

}  // namespace e2lf::recordings
