// SPDX-License-Identifier: MIT
#include "e2lf/recon/placed_images.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/recon/inversion.h"

namespace e2lf::recon {
namespace {

/// Returns the squared relative spread of the pictures at one pixel for a scene at `disparity`.
float mismatch(std::span<const PlacedImage> images, size_t height, size_t width, float disparity, size_t y, size_t x) {
  constexpr float kDark = 1e-2F;  // prevents the noise of dark pixels from dominating
  float sum = 0, squares = 0;
  for (const PlacedImage& image : images) {
    const float value = sample_bilinear(image.pixels, height, width,
                                        static_cast<float>(y) + disparity * static_cast<float>(image.view_y),
                                        static_cast<float>(x) + disparity * static_cast<float>(image.view_x));
    sum += value;
    squares += value * value;
  }
  const auto count = static_cast<float>(images.size());
  const float mean = sum / count;
  return std::max(0.0F, squares / count - mean * mean) / ((mean + kDark) * (mean + kDark));
}

}  // namespace

float sample_bilinear(std::span<const float> pixels, size_t height, size_t width, float y, float x) {
  y = std::clamp(y, 0.0F, static_cast<float>(height - 1));
  x = std::clamp(x, 0.0F, static_cast<float>(width - 1));
  const auto y0 = static_cast<size_t>(y), x0 = static_cast<size_t>(x);
  const size_t y1 = std::min(y0 + 1, height - 1), x1 = std::min(x0 + 1, width - 1);
  const float fy = y - static_cast<float>(y0), fx = x - static_cast<float>(x0);
  const float top = pixels[y0 * width + x0] * (1 - fx) + pixels[y0 * width + x1] * fx;
  const float bottom = pixels[y1 * width + x0] * (1 - fx) + pixels[y1 * width + x1] * fx;
  return top * (1 - fy) + bottom * fy;
}

std::vector<float> coded_disparity(std::span<const PlacedImage> images, size_t height, size_t width,
                                   const DisparitySearch& search) {
  E2LF_REQUIRE(search.step > 0 && search.largest >= 0, "a disparity search needs a positive step");
  std::vector<float> best(height * width), best_cost(height * width, std::numeric_limits<float>::infinity());
  const bool one_place = std::all_of(images.begin(), images.end(), [&](const PlacedImage& image) {
    return image.view_y == images[0].view_y && image.view_x == images[0].view_x;
  });
  if (one_place) return best;

  std::vector<float> differences(height * width);
  const int candidates = static_cast<int>(search.largest / search.step);
  for (int i = -candidates; i <= candidates; ++i) {
    const float disparity = static_cast<float>(i) * search.step;
    parallel_for(height, 4, [&](size_t begin, size_t end) {
      for (size_t p = begin * width; p < end * width; ++p) {
        differences[p] = mismatch(images, height, width, disparity, p / width, p % width);
      }
    });
    const std::vector<float> cost = box_sums(differences, height, width, search.radius);
    for (size_t p = 0; p < best.size(); ++p) {
      if (cost[p] < best_cost[p]) {
        best_cost[p] = cost[p];
        best[p] = disparity;
      }
    }
  }
  return best;
}

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
    return fail(ErrorCode::kInvalidValue, "",
                "no pattern is black, so events do not determine intensities; use a trained model");
  }
  if (images.count + 1 != codes.num_patterns) {
    return fail(ErrorCode::kShape, "", images.count, " event images do not fit ", codes.num_patterns,
                " patterns; use the patterns that the events were recorded with");
  }
  if (images.image_size() > 0) return black;
  return fail(ErrorCode::kShape, "", "images of ", images.width, "x", images.height, " are empty; give some pixels");
}

}  // namespace e2lf::recon
