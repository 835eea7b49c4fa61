// SPDX-License-Identifier: MIT
#include "e2lf/recon/placed_images.h"

#include <algorithm>

#include "e2lf/base/text.h"

namespace e2lf::recon {
namespace {

/// Places one coded image. The image of a black pattern has no pixels.
PlacedImage place_image(const capture::CodedIntensities& intensities, const capture::Codes& codes, size_t n) {
  PlacedImage image;
  double open = 0;
  const auto pattern = codes.pattern(n);
  for (size_t view = 0; view < pattern.size(); ++view) {
    open += pattern[view];
    image.view_y += pattern[view] * (static_cast<double>(view / codes.views_x) - view_centre(codes.views_y));
    image.view_x += pattern[view] * (static_cast<double>(view % codes.views_x) - view_centre(codes.views_x));
  }
  if (open == 0) return image;
  image.view_y /= open;
  image.view_x /= open;
  const auto scale = static_cast<float>(static_cast<double>(pattern.size()) / open);
  image.pixels.reserve(intensities.image_size());
  for (const float value : intensities.image(n)) image.pixels.push_back(scale * value);
  return image;
}

}  // namespace

PlacedImages place_images(const capture::CodedIntensities& intensities, const capture::Codes& codes) {
  PlacedImages placed;
  for (size_t n = 0; n < codes.num_patterns; ++n) {
    PlacedImage image = place_image(intensities, codes, n);
    if (image.pixels.empty()) continue;
    placed.images.push_back(std::move(image));
    placed.patterns.push_back(n);
  }
  return placed;
}

Result<size_t> black_pattern(const capture::EventImages& images, const capture::Codes& codes) {
  const auto is_black = [&](size_t n) {
    return std::all_of(codes.pattern(n).begin(), codes.pattern(n).end(), [](float value) { return value == 0; });
  };
  size_t black = 0;
  while (black < codes.num_patterns && !is_black(black)) ++black;
  if (black == codes.num_patterns) {
    return Error{ErrorCode::kInvalidValue,
                 "no pattern is black, so events do not determine intensities; use a trained model", ""};
  }
  if (images.count + 1 != codes.num_patterns) {
    return Error{ErrorCode::kShape,
                 cat(images.count, " event images do not fit ", codes.num_patterns,
                     " patterns; use the patterns that the events were recorded with"),
                 ""};
  }
  if (images.image_size() > 0) return black;
  return Error{ErrorCode::kShape, cat("images of ", images.width, "x", images.height, " are empty; give some pixels"),
               ""};
}

std::vector<float> disparity_in_view(const std::vector<float>& disparity, size_t height, size_t width, double view_y,
                                     double view_x) {
  std::vector<float> seen(disparity.size());
  for (size_t y = 0; y < height; ++y) {
    for (size_t x = 0; x < width; ++x) {
      // The disparity is known at the centre. A first guess determines where the pixel of this view lies there.
      const float guess = disparity[y * width + x];
      seen[y * width + x] =
          sample_bilinear(disparity, height, width, static_cast<float>(y) - guess * static_cast<float>(view_y),
                          static_cast<float>(x) - guess * static_cast<float>(view_x));
    }
  }
  return seen;
}

}  // namespace e2lf::recon
