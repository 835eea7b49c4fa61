// SPDX-License-Identifier: MIT
#include "e2lf/depth/colour_scale.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "e2lf/base/text.h"
#include "e2lf/depth/disparity_files.h"
#include "e2lf/lightfield/views.h"

namespace e2lf::depth {
namespace {

using lightfield::Image;

constexpr size_t kGlyphWidth = 3, kGlyphHeight = 5, kMargin = 6, kBarWidth = 14, kNumbers = 5;
/// The largest number of characters of a number, as in "-10.00".
constexpr size_t kLongestNumber = 6;

/// A character of 3x5 px, row by row, '#' for ink.
struct Glyph {
  char character;
  std::string_view ink;
};
constexpr std::array<Glyph, 12> kGlyphs = {{{'0', "####.##.##.####"},
                                            {'1', ".#.##..#..#.###"},
                                            {'2', "###..#####..###"},
                                            {'3', "###..####..####"},
                                            {'4', "#.##.####..#..#"},
                                            {'5', "####..###..####"},
                                            {'6', "####..####.####"},
                                            {'7', "###..#..#..#..#"},
                                            {'8', "####.#####.####"},
                                            {'9', "####.####..####"},
                                            {'-', "......###......"},
                                            {'.', ".............#."}}};

void fill(Image& canvas, size_t top, size_t left, size_t side, float value) {
  for (size_t y = top; y < std::min(top + side, canvas.height); ++y) {
    for (size_t x = left; x < std::min(left + side, canvas.width); ++x) {
      std::fill_n(canvas.pixels.data() + (y * canvas.width + x) * 3, 3, value);
    }
  }
}

void write_number(Image& canvas, size_t top, size_t left, size_t times, float number) {
  for (const char character : formatted("%.2f", double{number})) {
    const auto* const glyph = std::ranges::find(kGlyphs, character, &Glyph::character);
    for (size_t i = 0; i < glyph->ink.size(); ++i) {
      if (glyph->ink[i] != '#') continue;
      fill(canvas, top + i / kGlyphWidth * times, left + i % kGlyphWidth * times, times, 0.0F);
    }
    left += (kGlyphWidth + 1) * times;
  }
}

}  // namespace

Image picture_with_scale(const Image& disparity, const DisparityRange& range) {
  constexpr size_t kLeastHeight = 64;
  const size_t width = disparity.width, height = disparity.height;
  const bool has_numbers = height >= kLeastHeight;
  const size_t times = height >= 4 * kLeastHeight ? 2 : 1;
  const size_t numbers_width = has_numbers ? kLongestNumber * (kGlyphWidth + 1) * times + kMargin : 0;
  Image canvas(width + kMargin + kBarWidth + kMargin + numbers_width, height, 3);
  std::fill(canvas.pixels.begin(), canvas.pixels.end(), 1.0F);
  const auto disparity_at = [&](size_t y) {
    const auto share = static_cast<float>(y) / static_cast<float>(std::max<size_t>(height, 2) - 1);
    return range.most + share * (range.least - range.most);
  };
  Image bar(kBarWidth, height, 1);
  for (size_t i = 0; i < bar.pixels.size(); ++i) bar.pixels[i] = disparity_at(i / kBarWidth);
  paste(colour_picture(disparity, range), 0, 0, canvas);
  paste(colour_picture(bar, range), 0, width + kMargin, canvas);
  for (size_t i = 0; has_numbers && i < kNumbers; ++i) {
    write_number(canvas, (height - kGlyphHeight * times) * i / (kNumbers - 1), width + 2 * kMargin + kBarWidth, times,
                 disparity_at((height - 1) * i / (kNumbers - 1)));
  }
  return canvas;
}

}  // namespace e2lf::depth
