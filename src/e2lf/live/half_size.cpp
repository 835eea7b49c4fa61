// SPDX-License-Identifier: MIT
#include "e2lf/live/half_size.h"

#include <algorithm>

#include "e2lf/base/contract.h"

namespace e2lf::live {

void sum_blocks(const capture::EventImages& images, capture::EventImages& half) {
  const size_t height = images.height / 2, width = images.width / 2;
  E2LF_REQUIRE(height > 0 && width > 0, "images of half the resolution need at least 2x2 pixels");
  if (half.transitions != images.transitions || half.height != height || half.width != width) {
    half = capture::EventImages(images.transitions, height, width);
  }
  for (size_t transition = 0; transition < images.transitions; ++transition) {
    const int16_t* const image = images.image(transition).data();
    int16_t* to = half.image(transition).data();
    for (size_t y = 0; y < height; ++y) {
      const int16_t* const upper = image + 2 * y * images.width;
      const int16_t* const lower = upper + images.width;
      for (size_t x = 0; x < width; ++x) {
        const int sum = upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1];
        *to++ = static_cast<int16_t>(std::clamp(sum, INT16_MIN, INT16_MAX));
      }
    }
  }
}

}  // namespace e2lf::live
