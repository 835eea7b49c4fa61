// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/report/table.h"

namespace e2lf::report {

/// A picture for a page: the bytes of a PNG.
struct Picture {
  std::span<const uint8_t> png;
  std::string caption;
};

/// One page of HTML with nothing outside it, dark or light as the reader's system is. Texts are escaped here.
class Page {
 public:
  explicit Page(std::string title);

  Page& heading(std::string_view text, int level = 2);  ///< level 2 to 4
  Page& paragraph(std::string_view text);
  Page& code(std::string_view text);
  Page& table(const Table& table);
  /// What is known of something, a line for each value: facts_table().
  Page& facts(const Json& facts);
  /// What is added between these stands side by side, as much as fits.
  Page& begin_row();
  Page& end_row();
  /// A row of them.
  Page& pictures(const std::vector<Picture>& pictures);
  /// SVG as the charts make it, which is taken as it is.
  Page& drawing(std::string_view svg, std::string_view caption = "");

  [[nodiscard]] std::string html() const;

  /// Those added by table(), in order.
  [[nodiscard]] const std::vector<Table>& tables() const { return tables_; }

 private:
  Page& add(const Table& table);

  std::string title_, body_;
  std::vector<Table> tables_;
};

/// What a file of a report holds.
enum class FileFormat {
  kHtml,   ///< the page
  kCsv,    ///< its first table
  kLatex,  ///< all of its tables
};

/// By the extension: .html, .csv or .tex. Fails with kUnsupported.
[[nodiscard]] Result<FileFormat> file_format_of(const std::filesystem::path& path);

/// A page without tables breaks the contract where its tables are asked for.
[[nodiscard]] std::string file_text(const Page& page, FileFormat format);

}  // namespace e2lf::report
