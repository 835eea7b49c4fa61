// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/report/table.h"

namespace e2lf::report {

/// A picture for a page, as the bytes of a PNG file.
struct Picture {
  std::vector<uint8_t> png;
  std::string caption;
};

/// A self-contained HTML page, dark or light according to the system of the reader. All texts are escaped here.
class Page {
 public:
  explicit Page(std::string title);

  Page& heading(std::string_view text, int level = 2);  ///< level 2 to 4
  Page& paragraph(std::string_view text);
  Page& code(std::string_view text);
  Page& table(const Table& table);
  /// Adds the values of an object as a table with one row per value; see facts_table().
  Page& facts(const Json& facts) { return add(facts_table(facts)); }
  /// Places all elements that are added between these two calls side by side, as far as they fit.
  Page& begin_row();
  Page& end_row();
  /// Adds the pictures in a row.
  Page& pictures(const std::vector<Picture>& pictures);
  /// Adds SVG made by the chart functions; it is not escaped.
  Page& drawing(std::string_view svg, std::string_view caption = "");

  [[nodiscard]] std::string html() const;

  /// Returns the tables added by table(), in order.
  [[nodiscard]] const std::vector<Table>& tables() const { return tables_; }
  /// Returns the first drawing, or an empty text.
  [[nodiscard]] const std::string& first_drawing() const { return first_drawing_; }

 private:
  Page& add(const Table& table);

  std::string title_, body_, first_drawing_;
  std::vector<Table> tables_;
};

/// Returns the text of a report file: the page (.html), its first table (.csv), all of its tables (.tex) or its first
/// drawing (.svg). A page without tables breaks the contract for .csv and .tex. Fails with kUnsupported for .svg if the
/// page has no drawing, and as check_extension() does.
[[nodiscard]] Result<std::string> file_text(const Page& page, const std::filesystem::path& path);

/// Fails with kUnsupported if a report file cannot have the extension of `path`.
[[nodiscard]] Result<void> check_extension(const std::filesystem::path& path);

/// Escapes a text for HTML and XML, for use in elements and in quoted attributes: `& < > " '` become entities. Bytes
/// that are not valid UTF-8, which names of files may contain, and characters that XML forbids become U+FFFD.
[[nodiscard]] std::string escaped(std::string_view text);

/// Escapes a text for LaTeX: special characters are escaped, and line ends and tabs become spaces. Invalid bytes are
/// replaced as in escaped().
[[nodiscard]] std::string latex_escaped(std::string_view text);

/// Returns the number of characters in a UTF-8 text, i.e. of the bytes that are not continuation bytes.
[[nodiscard]] size_t num_characters(std::string_view text);

/// Encodes bytes in Base64 (RFC 4648), padded with "=".
[[nodiscard]] std::string base64(std::span<const uint8_t> bytes);

}  // namespace e2lf::report
