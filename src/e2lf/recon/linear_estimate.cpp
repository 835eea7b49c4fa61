// SPDX-License-Identifier: MIT
#include "e2lf/recon/linear_estimate.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/recon/denoise.h"
#include "e2lf/recon/inversion.h"

namespace e2lf::recon {
namespace {

double centre(size_t views) {
  return (static_cast<double>(views) - 1) / 2;
}

/// Coded image n as a picture from its pattern's centre of light; a black pattern gives no pixels.
PlacedImage place_image(const capture::CodedIntensities& intensities, const capture::Codes& codes, size_t n) {
  PlacedImage image;
  double open = 0;
  const auto pattern = codes.pattern(n);
  for (size_t view = 0; view < pattern.size(); ++view) {
    open += pattern[view];
    image.view_y += pattern[view] * (static_cast<double>(view / codes.views_x) - centre(codes.views_y));
    image.view_x += pattern[view] * (static_cast<double>(view % codes.views_x) - centre(codes.views_x));
  }
  if (open == 0) return image;
  image.view_y /= open;
  image.view_x /= open;
  const auto scale = static_cast<float>(static_cast<double>(pattern.size()) / open);
  image.pixels.reserve(intensities.image_size());
  for (const float value : intensities.image(n)) image.pixels.push_back(scale * value);
  return image;
}

struct View {
  double y = 0, x = 0;  ///< relative to the centre of the views
  std::vector<float> weights;
};

/// One row of one view: the weighted sum of the pictures at the places where each sees the same point.
void render_row(const View& view, std::span<const PlacedImage> images, std::span<const float> disparity,
                const lightfield::Shape& shape, size_t y, std::span<float> row) {
  const size_t height = shape.height, width = shape.width;
  for (size_t x = 0; x < width; ++x) {
    const auto fy = static_cast<float>(y), fx = static_cast<float>(x);
    // The disparity is known at the centre; the first guess tells where this view's pixel lies there.
    const float guess = disparity[y * width + x];
    const float d = sample_bilinear(disparity, height, width, fy - guess * static_cast<float>(view.y),
                                    fx - guess * static_cast<float>(view.x));
    float sum = 0;
    for (size_t n = 0; n < images.size(); ++n) {
      sum += view.weights[n] * sample_bilinear(images[n].pixels, height, width,
                                               fy + d * static_cast<float>(images[n].view_y - view.y),
                                               fx + d * static_cast<float>(images[n].view_x - view.x));
    }
    row[x] = sum;
  }
}

template <class Images>
Result<void> check_not_empty(const Images& images) {
  if (images.image_size() > 0) return {};
  return Error{ErrorCode::kShape, cat("images of ", images.width, "x", images.height, " are empty; give some pixels"),
               ""};
}

}  // namespace

Result<lightfield::LightField> linear_estimate(const capture::CodedIntensities& intensities,
                                               const capture::Codes& codes, const LinearEstimateOptions& options) {
  if (intensities.num_patterns != codes.num_patterns) {
    return Error{ErrorCode::kShape,
                 cat("there are ", intensities.num_patterns, " coded images but ", codes.num_patterns,
                     " patterns; use the patterns that the events were recorded with"),
                 ""};
  }
  E2LF_RETURN_IF_ERROR(check_not_empty(intensities));
  std::vector<PlacedImage> images;
  std::vector<size_t> lit;
  for (size_t n = 0; n < codes.num_patterns; ++n) {
    PlacedImage image = place_image(intensities, codes, n);
    if (image.pixels.empty()) continue;
    images.push_back(std::move(image));
    lit.push_back(n);
  }
  if (lit.empty()) return Error{ErrorCode::kInvalidValue, "every pattern is black; use patterns with open cells", ""};

  lightfield::LightField light_field({codes.views_y, codes.views_x, intensities.height, intensities.width});
  const lightfield::Shape& shape = light_field.shape();
  const std::vector<float> disparity = coded_disparity(images, shape.height, shape.width, options.search);
  const auto weights = view_weights(codes, options.prior);
  parallel_for(shape.num_views() * shape.height, 8, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const size_t number = i / shape.height, y = i % shape.height;
      View view{static_cast<double>(number / shape.views_x) - centre(shape.views_y),
                static_cast<double>(number % shape.views_x) - centre(shape.views_x),
                {}};
      for (const size_t n : lit) view.weights.push_back(static_cast<float>(weights[number][n]));
      render_row(view, images, disparity, shape, y, light_field.data().subspan(i * shape.width, shape.width));
    }
  });
  return light_field;
}

Result<lightfield::LightField> reconstruct_by_inversion(const capture::EventImages& images, const capture::Codes& codes,
                                                        const capture::SensorConstants& constants,
                                                        const LinearEstimateOptions& options) {
  InversionOptions inversion;
  inversion.constants = constants;
  inversion.centred = true;
  const auto is_black = [&](size_t n) {
    return std::all_of(codes.pattern(n).begin(), codes.pattern(n).end(), [](float value) { return value == 0; });
  };
  while (inversion.black < codes.num_patterns && !is_black(inversion.black)) ++inversion.black;
  if (inversion.black == codes.num_patterns) {
    return Error{ErrorCode::kInvalidValue,
                 "no pattern is black, so events do not tell intensities; use a trained model", ""};
  }
  if (images.transitions + 1 != codes.num_patterns) {
    return Error{ErrorCode::kShape,
                 cat(images.transitions, " event images do not fit ", codes.num_patterns,
                     " patterns; use the patterns that the events were recorded with"),
                 ""};
  }
  E2LF_RETURN_IF_ERROR(check_not_empty(images));
  E2LF_ASSIGN_OR_RETURN(capture::CodedIntensities intensities, invert_events(images, inversion));
  denoise_intensities(intensities, images, constants, options.denoise_radius);
  return linear_estimate(intensities, codes, options);
}

}  // namespace e2lf::recon
