// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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
  /// What is added between these stands side by side, as much as fits.
  Page& begin_row();
  Page& end_row();
  /// A row of them.
  Page& pictures(const std::vector<Picture>& pictures);
  /// SVG as the charts make it, which is taken as it is.
  Page& drawing(std::string_view svg, std::string_view caption = "");

  [[nodiscard]] std::string html() const;

 private:
  std::string title_, body_;
};

}  // namespace e2lf::report
