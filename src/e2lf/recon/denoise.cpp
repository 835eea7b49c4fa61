// SPDX-License-Identifier: MIT
#include "e2lf/recon/denoise.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/result.h"
#include "e2lf/base/threads.h"

namespace e2lf::recon {
namespace {

/// Computes sliding sums of `count` values that are `stride` apart. The end values are repeated.
void line_sums(const float* in, float* out, size_t count, size_t stride, size_t radius) {
  const auto last = static_cast<ptrdiff_t>(count) - 1, reach = static_cast<ptrdiff_t>(radius);
  const auto at = [&](ptrdiff_t i) {
    return double{in[static_cast<size_t>(std::clamp<ptrdiff_t>(i, 0, last)) * stride]};
  };
  double sum = 0;
  for (ptrdiff_t i = -reach; i <= reach; ++i) sum += at(i);
  for (ptrdiff_t i = 0; i <= last; ++i) {
    out[static_cast<size_t>(i) * stride] = static_cast<float>(sum);
    sum += at(i + reach + 1) - at(i - reach);
  }
}

void denoise_image(std::span<float> image, std::span<const int16_t> counts, const capture::EventImages& images,
                   const capture::SensorConstants& constants, size_t radius) {
  const auto& [eps, tau, sigma_w, sigma_z, sigma_i] = constants;
  const float fixed = sigma_w * sigma_w + tau * tau / 12;
  std::vector<float> value(image.size()), square(image.size()), noise(image.size());
  for (size_t i = 0; i < image.size(); ++i) {
    value[i] = std::log(std::max(image[i], 0.0F) + eps);
    square[i] = value[i] * value[i];
    const float events = sigma_z * static_cast<float>(counts[i]);
    noise[i] = fixed + events * events;
  }
  const auto values = box_sums(value, images.height, images.width, radius);
  const auto squares = box_sums(square, images.height, images.width, radius);
  const auto noises = box_sums(noise, images.height, images.width, radius);
  const auto area = static_cast<float>((2 * radius + 1) * (2 * radius + 1));
  for (size_t i = 0; i < image.size(); ++i) {
    const float mean = values[i] / area, variance = squares[i] / area - mean * mean;
    const float keep = variance > 0 ? std::max(0.0F, 1 - noises[i] / area / variance) : 0.0F;
    image[i] = std::max(0.0F, std::exp(mean + keep * (value[i] - mean)) - eps);
  }
}

}  // namespace

std::vector<float> box_sums(std::span<const float> values, size_t height, size_t width, size_t radius) {
  std::vector<float> rows(values.size()), sums(values.size());
  parallel_for(height, 8, [&](size_t begin, size_t end) {
    for (size_t y = begin; y < end; ++y) line_sums(&values[y * width], &rows[y * width], width, 1, radius);
  });
  parallel_for(width, 16, [&](size_t begin, size_t end) {
    for (size_t x = begin; x < end; ++x) line_sums(&rows[x], &sums[x], height, width, radius);
  });
  return sums;
}

void denoise_intensities(capture::CodedIntensities& intensities, const capture::EventImages& images,
                         const capture::SensorConstants& constants, size_t radius) {
  E2LF_REQUIRE(intensities.count == images.count + 1 && intensities.image_size() == images.image_size(),
               "coded intensities and event images must belong together");
  for (size_t k = 0; k < images.count; ++k) {
    denoise_image(intensities.image(k + 1), images.image(k), images, constants, radius);
  }
}

}  // namespace e2lf::recon
