// SPDX-License-Identifier: MIT
// Prints patterns as text; declared in codes_io.h.
#include <algorithm>
#include <cmath>
#include <string_view>

#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes_io.h"

namespace e2lf::capture {
namespace {

constexpr size_t kPatternsPerLine = 4;
constexpr size_t kGap = 3;  // spaces between patterns

/// Appends `text` and pads it to `width`.
void append_padded(std::string& line, std::string text, size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  line += text;
}

/// Returns a row of cells separated by spaces, which makes them approximately square.
std::string row_text(std::span<const float> row) {
  constexpr std::string_view kLevels = ".:-=+*#";
  std::string text;
  for (const float value : row) {
    text += kLevels[static_cast<size_t>(std::lround(value * static_cast<float>(kLevels.size() - 1)))];
    text += ' ';
  }
  text.pop_back();
  return text;
}

void append_line(std::string& text, std::string line) {
  line.resize(line.find_last_not_of(' ') + 1);
  text += line + '\n';
}

}  // namespace

std::string codes_text(const Codes& codes) {
  E2LF_REQUIRE(validate(codes, "").ok(), "the patterns are not valid");
  const std::vector<float> efficiency = light_efficiency(codes);
  const size_t width = std::max<size_t>(2 * codes.views_x - 1, 9) + kGap;
  std::string text;
  for (size_t begin = 0; begin < codes.num_patterns; begin += kPatternsPerLine) {
    const size_t end = std::min(begin + kPatternsPerLine, codes.num_patterns);
    if (begin > 0) text += '\n';
    std::string title;
    for (size_t n = begin; n < end; ++n) {
      append_padded(title, cat(n + 1, ": ", std::lround(efficiency[n] * 100.0F), " %"), width);
    }
    append_line(text, title);
    for (size_t view_y = 0; view_y < codes.views_y; ++view_y) {
      std::string line;
      for (size_t n = begin; n < end; ++n) {
        append_padded(line, row_text(codes.pattern(n).subspan(view_y * codes.views_x, codes.views_x)), width);
      }
      append_line(text, line);
    }
  }
  return text;
}

}  // namespace e2lf::capture
