// SPDX-License-Identifier: MIT
#include "e2lf/recon/linear_estimate.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/recon/denoise.h"
#include "e2lf/recon/inversion.h"
#include "e2lf/recon/placed_images.h"

namespace e2lf::recon {
namespace {

struct View {
  double y = 0, x = 0;  ///< relative to the centre of the views
  std::vector<float> weights;
};

/// Renders one row of a view as the weighted sum of the pictures, each sampled where it shows the same point.
void render_row(const View& view, std::span<const PlacedImage> images, std::span<const float> disparity,
                const lightfield::Shape& shape, size_t y, std::span<float> row) {
  const size_t height = shape.height, width = shape.width;
  for (size_t x = 0; x < width; ++x) {
    const auto fy = static_cast<float>(y), fx = static_cast<float>(x);
    // The disparity is known at the centre. A first guess determines where the pixel of this view lies there.
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

Result<void> check_not_empty(const capture::CodedIntensities& images) {
  if (images.image_size() > 0) return {};
  return Error{ErrorCode::kShape, cat("images of ", images.width, "x", images.height, " are empty; give some pixels"),
               ""};
}

}  // namespace

Result<lightfield::LightField> linear_estimate(const capture::CodedIntensities& intensities,
                                               const capture::Codes& codes, const LinearEstimateOptions& options) {
  if (intensities.count != codes.num_patterns) {
    return Error{ErrorCode::kShape,
                 cat("there are ", intensities.count, " coded images but ", codes.num_patterns,
                     " patterns; use the patterns that the events were recorded with"),
                 ""};
  }
  E2LF_RETURN_IF_ERROR(check_not_empty(intensities));
  const PlacedImages placed = place_images(intensities, codes);
  const std::vector<PlacedImage>& images = placed.images;
  const std::vector<size_t>& lit = placed.patterns;
  if (lit.empty()) return Error{ErrorCode::kInvalidValue, "every pattern is black; use patterns with open cells", ""};

  lightfield::LightField light_field({codes.views_y, codes.views_x, intensities.height, intensities.width});
  const lightfield::Shape& shape = light_field.shape();
  const std::vector<float> disparity = coded_disparity(images, shape.height, shape.width, options.search);
  const auto weights = view_weights(codes, options.prior);
  parallel_for(shape.num_views() * shape.height, 8, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const size_t number = i / shape.height, y = i % shape.height;
      View view{static_cast<double>(number / shape.views_x) - view_centre(shape.views_y),
                static_cast<double>(number % shape.views_x) - view_centre(shape.views_x),
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
  E2LF_ASSIGN_OR_RETURN(inversion.black, black_pattern(images, codes));
  E2LF_ASSIGN_OR_RETURN(capture::CodedIntensities intensities, invert_events(images, inversion));
  denoise_intensities(intensities, images, constants, options.denoise_radius);
  return linear_estimate(intensities, codes, options);
}

}  // namespace e2lf::recon
