// SPDX-License-Identifier: MIT
#include "e2lf/depth/disparity_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/lightfield/views.h"

// These symbols are defined in legend_glyphs.S.
extern "C" {
extern const uint8_t kGlyphsBegin[] asm("e2lf_depth_glyphs_begin");
extern const uint8_t kGlyphsEnd[] asm("e2lf_depth_glyphs_end");
}

namespace e2lf::depth {
using lightfield::Image;
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

using Colour = std::array<float, 3>;

/// The colours from far to near, equally spaced: perceptually uniform, and the lightness alone states the order.
constexpr std::array<Colour, 5> kColours = {{{0.267F, 0.004F, 0.329F},
                                             {0.231F, 0.322F, 0.545F},
                                             {0.129F, 0.569F, 0.549F},
                                             {0.369F, 0.788F, 0.384F},
                                             {0.992F, 0.906F, 0.145F}}};
constexpr Colour kUnknown = {0.5F, 0.5F, 0.5F};

/// Returns the colour of a `nearness` in [0, 1].
Colour colour_of(float nearness) {
  const float place = nearness * static_cast<float>(kColours.size() - 1);
  const size_t before = std::min(static_cast<size_t>(place), kColours.size() - 2);
  const float t = place - static_cast<float>(before);
  Colour colour;
  for (size_t c = 0; c < 3; ++c) colour[c] = (1 - t) * kColours[before][c] + t * kColours[before + 1][c];
  return colour;
}

/// A bar of colours with numbers beside it, below a line that states the unit.
class Legend {
 public:
  /// `wanted` is the height of the picture, which the legend exceeds if it does not hold two numbers.
  Legend(const DisparityRange& range, size_t wanted)
      : range_(range),
        line_(std::clamp<size_t>(wanted / 28, 14, 40)),
        bar_height_(wanted < 4 * line_ ? 2 * line_ : wanted - 2 * line_) {
    const size_t numbers = std::clamp<size_t>(bar_height_ / (2 * line_) + 1, 2, 5);
    for (size_t i = 0; i < numbers; ++i) {
      const float share = static_cast<float>(i) / static_cast<float>(numbers - 1);
      const char* const end = i == 0 ? " near" : i + 1 == numbers ? " far" : "";
      labels_.push_back(
          text_picture(formatted("%.2f", double{range.least + share * (range.most - range.least)}) + end, line_));
      width_ = std::max(width_, line_ + gap() + labels_.back().width);
    }
    width_ = std::max(width_, unit_.width);
  }

  [[nodiscard]] size_t gap() const { return line_ / 2; }
  [[nodiscard]] size_t width() const { return width_; }
  [[nodiscard]] size_t height() const { return 2 * line_ + bar_height_; }

  void draw(Image& canvas, size_t left) const {
    paste(unit_, 0, left, canvas);
    const size_t top = line_ + line_ / 2;
    Image bar(line_, bar_height_, 1);
    for (size_t i = 0; i < bar.pixels.size(); ++i) {
      const float share = static_cast<float>(i / line_) / static_cast<float>(bar_height_ - 1);
      bar.pixels[i] = range_.least + share * (range_.most - range_.least);
    }
    paste(colour_picture(bar, range_), top, left, canvas);
    // Each number stands in the middle of its colour.
    for (size_t i = 0; i < labels_.size(); ++i) {
      paste(labels_[i], line_ + bar_height_ * i / (labels_.size() - 1), left + line_ + gap(), canvas);
    }
  }

 private:
  DisparityRange range_;
  size_t line_, bar_height_, width_ = 0;
  Image unit_ = text_picture("px per view step", line_);
  std::vector<Image> labels_;
};

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

Image colour_picture(const Image& disparity, const DisparityRange& range) {
  const float width = std::max(range.most - range.least, 1e-3F);
  Image picture(disparity.width, disparity.height, 3);
  for (size_t i = 0; i < disparity.pixels.size(); ++i) {
    const float nearness = (range.most - disparity.pixels[i]) / width;
    const Colour colour = std::isfinite(nearness) ? colour_of(std::clamp(nearness, 0.0F, 1.0F)) : kUnknown;
    std::copy(colour.begin(), colour.end(), picture.pixels.begin() + static_cast<ptrdiff_t>(3 * i));
  }
  return picture;
}

Image picture_with_scale(const Image& disparity, const DisparityRange& range) {
  const Legend legend(range, disparity.height);
  Image canvas(disparity.width + 2 * legend.gap() + legend.width(), std::max(disparity.height, legend.height()), 3);
  std::ranges::fill(canvas.pixels, 1.0F);
  paste(colour_picture(disparity, range), 0, 0, canvas);
  legend.draw(canvas, disparity.width + legend.gap());
  return canvas;
}

DisparityRange shown_range(const Image& disparity) {
  std::vector<float> sorted = disparity.pixels;
  std::erase_if(sorted, [](float value) { return !std::isfinite(value); });
  if (sorted.empty()) return {};
  std::ranges::sort(sorted);
  const size_t last = sorted.size() - 1, few = last / 100;
  return {sorted[few], sorted[last - few]};
}

DisparityRange shown_range(const Image& disparity, const Image& confidence) {
  E2LF_REQUIRE(confidence.pixels.size() == disparity.pixels.size(), "each disparity has a confidence");
  Image certain;
  for (size_t i = 0; i < disparity.pixels.size(); ++i) {
    if (confidence.pixels[i] >= kLeastConfidence) certain.pixels.push_back(disparity.pixels[i]);
  }
  return shown_range(certain.pixels.size() < disparity.pixels.size() / 20 + 1 ? disparity : certain);
}

}  // namespace e2lf::depth
