// SPDX-License-Identifier: MIT
#include "e2lf/depth/legend.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "e2lf/lightfield/views.h"

// These symbols are defined in legend_glyphs.S.
extern "C" {
extern const uint8_t kGlyphsBegin[] asm("e2lf_depth_glyphs_begin");
extern const uint8_t kGlyphsEnd[] asm("e2lf_depth_glyphs_end");
}

namespace e2lf::depth {
namespace {

// As scripts/draw_legend_glyphs.mjs prints them.
constexpr std::string_view kCharacters = "0123456789-.aefinprstvwx ";
constexpr std::array<size_t, kCharacters.size()> kWidths = {32, 32, 32, 32, 32, 32, 32, 32, 32, 32, 42, 16, 31,
                                                            31, 18, 14, 32, 32, 21, 26, 20, 30, 41, 30, 16};

/// Returns all characters side by side, white on black.
const lightfield::Image& glyphs() {
  static const lightfield::Image picture =
      lightfield::to_grey(lightfield::decode_image({kGlyphsBegin, kGlyphsEnd}, "legend_glyphs.png").value());
  return picture;
}

}  // namespace

lightfield::Image text_picture(std::string_view text, size_t height) {
  const lightfield::Image& all = glyphs();
  E2LF_REQUIRE(height >= 1 && height <= all.height, "the height of a legend's text is 1 to 64 px");
  std::vector<size_t> numbers;
  for (const char character : text) {
    numbers.push_back(kCharacters.find(character));
    E2LF_REQUIRE(numbers.back() < kCharacters.size(), "legends have no such character");
  }
  size_t width = 0;
  for (const size_t number : numbers) width += kWidths[number];
  lightfield::Image line(std::max<size_t>(width, 1), all.height, 1);
  size_t left = 0;
  for (const size_t number : numbers) {
    const size_t from = std::accumulate(kWidths.begin(), kWidths.begin() + static_cast<ptrdiff_t>(number), size_t{0});
    for (size_t y = 0; y < all.height; ++y) {
      std::copy_n(all.pixels.data() + y * all.width + from, kWidths[number],
                  line.pixels.data() + y * line.width + left);
    }
    left += kWidths[number];
  }
  for (float& value : line.pixels) value = 1 - value;
  return lightfield::shrink(line, std::max<size_t>(1, line.width * height / all.height), height);
}

}  // namespace e2lf::depth
