// SPDX-License-Identifier: MIT
#include "e2lf/sensor/intensity_images.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/sensor/coded_intensity.h"
#include "e2lf/sensor/draws.h"

namespace e2lf::sensor {
namespace {

using capture::kLensPixels;

Result<CodedIntensities> lens_array_image(const lightfield::LightField& light_field) {
  const lightfield::Shape& shape = light_field.shape();
  if (shape.views_y != kLensPixels || shape.views_x != kLensPixels || shape.channels != 1) {
    return Error{ErrorCode::kShape,
                 cat("a lens array has 8x8 grey views, the light field has ", shape.views_y, "x", shape.views_x, " of ",
                     shape.channels, " channels; give 8x8 grey views"),
                 ""};
  }
  const auto lenses = [](size_t length) { return (length + kLensPixels - 1) / kLensPixels; };
  CodedIntensities image(1, lenses(shape.height) * kLensPixels, lenses(shape.width) * kLensPixels);
  parallel_for(lenses(shape.height), 1, [&](size_t begin, size_t end) {
    for (size_t y = begin * kLensPixels; y < end * kLensPixels; ++y) {
      for (size_t x = 0; x < image.width; ++x) {
        const size_t view = y % kLensPixels * kLensPixels + x % kLensPixels;
        const size_t top = y / kLensPixels * kLensPixels, left = x / kLensPixels * kLensPixels;
        const size_t bottom = std::min(top + kLensPixels, shape.height);
        const size_t right = std::min(left + kLensPixels, shape.width);
        float sum = 0;
        for (size_t j = top; j < bottom; ++j) {
          const float* row = light_field.data().data() + view * shape.view_size() + j * shape.width;
          for (size_t i = left; i < right; ++i) sum += row[i];
        }
        image.values[y * image.width + x] = sum / static_cast<float>((bottom - top) * (right - left));
      }
    }
  });
  return image;
}

CodedIntensities sum_of(const CodedIntensities& intensities) {
  CodedIntensities sum(1, intensities.height, intensities.width);
  for (size_t n = 0; n < intensities.count; ++n) {
    const auto image = intensities.image(n);
    for (size_t i = 0; i < image.size(); ++i) sum.values[i] += image[i];
  }
  return sum;
}

void add_noise(const ImageOptions& options, CodedIntensities& images) {
  for (size_t n = 0; n < images.count; ++n) {
    const CounterRng rng(options.seed, kImageStream + n);
    const auto image = images.image(n);
    parallel_for(image.size(), 4096, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) image[i] = options.gain * image[i] + options.sigma * rng.normal2(i)[0];
    });
  }
}

}  // namespace

Result<CodedIntensities> measure_images(capture::MeasurementKind kind, const capture::Codes& codes,
                                        const lightfield::LightField& light_field, const ImageOptions& options) {
  for (const auto& [name, value] : {std::pair("gain", options.gain), std::pair("noise", options.sigma)}) {
    if (std::isfinite(value) && value >= 0.0F) continue;
    return Error{ErrorCode::kInvalidValue, cat("the ", name, " of intensity images is ", value, "; give zero or more"),
                 ""};
  }
  CodedIntensities images;
  if (kind == capture::MeasurementKind::kEventImages) return images;
  if (kind == capture::MeasurementKind::kLensArray) {
    E2LF_ASSIGN_OR_RETURN(images, lens_array_image(light_field));
  } else {
    E2LF_ASSIGN_OR_RETURN(images, coded_intensities(codes, light_field));
    if (kind == capture::MeasurementKind::kHybrid) images = sum_of(images);
  }
  add_noise(options, images);
  return images;
}

}  // namespace e2lf::sensor
