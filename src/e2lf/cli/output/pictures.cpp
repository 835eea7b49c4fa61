// SPDX-License-Identifier: MIT
#include "e2lf/cli/output/pictures.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <vector>

namespace e2lf::cli {
namespace {

float bright_count(const capture::EventImages& images) {
  std::vector<int16_t> counts = images.values;
  for (int16_t& count : counts) count = static_cast<int16_t>(std::min(std::abs(int{count}), 32767));
  const auto quantile = counts.begin() + static_cast<ptrdiff_t>((counts.size() - 1) * 99 / 100);
  std::nth_element(counts.begin(), quantile, counts.end());
  return static_cast<float>(std::max<int>(*quantile, 1));
}

std::array<float, 3> colour_of(float value) {
  constexpr float kGrey = 0.92F;
  const float strength = std::min(std::abs(value), 1.0F);
  const float faded = kGrey * (1.0F - strength);
  return value >= 0 ? std::array{kGrey, faded, faded} : std::array{faded, faded, kGrey};
}

}  // namespace

lightfield::Image event_picture(const capture::EventImages& images) {
  constexpr size_t kGap = 4;
  lightfield::Image picture(images.count * (images.width + kGap) - kGap, images.height, 3);
  std::fill(picture.pixels.begin(), picture.pixels.end(), 1.0F);
  const float scale = 1.0F / bright_count(images);
  for (size_t k = 0; k < images.count; ++k) {
    const auto image = images.image(k);
    for (size_t y = 0; y < images.height; ++y) {
      float* row = picture.pixels.data() + (y * picture.width + k * (images.width + kGap)) * 3;
      for (size_t x = 0; x < images.width; ++x) {
        const auto colour = colour_of(scale * static_cast<float>(image[y * images.width + x]));
        std::copy(colour.begin(), colour.end(), row + 3 * x);
      }
    }
  }
  return picture;
}

}  // namespace e2lf::cli
