// SPDX-License-Identifier: MIT
#include "e2lf/streams/shown_light.h"

#include <algorithm>

#include "e2lf/base/threads.h"
#include "e2lf/sensor/coded_intensity.h"

namespace e2lf::streams {
namespace {

constexpr size_t kLeastPixels = 4096;  // the fewest per thread

/// Appends a pattern with all cells open.
capture::Codes with_open_aperture(const capture::Codes& codes) {
  capture::Codes extended(codes.num_patterns + 1, codes.views_y, codes.views_x);
  std::fill(extended.values.begin(), extended.values.end(), 1.0F);
  std::copy(codes.values.begin(), codes.values.end(), extended.values.begin());
  return extended;
}

}  // namespace

ShownLight::ShownLight(const capture::Codes& codes, const capture::SensorProfile& camera, float gain, size_t height,
                       size_t width)
    : codes_(with_open_aperture(codes)),
      transmission_(codes.num_patterns - 1),
      gain_(gain),
      leak_(camera.pixel[capture::PixelConstant::kLeak]) {
  const float middle_x = 0.5F * static_cast<float>(width), middle_y = 0.5F * static_cast<float>(height);
  for (size_t n = 0; n < transmission_.size(); ++n) {
    transmission_[n].resize(height * width);
    parallel_for(height, kLeastPixels / width + 1, [&](size_t begin, size_t end) {
      for (size_t y = begin; y < end; ++y) {
        const float place_y = (static_cast<float>(y) + 0.5F - middle_y) / middle_x;
        for (size_t x = 0; x < width; ++x) {
          const float place_x = (static_cast<float>(x) + 0.5F - middle_x) / middle_x;
          transmission_[n][y * width + x] = capture::transmission_at(camera, n, place_x, place_y);
        }
      }
    });
  }
}

Result<capture::CodedIntensities> ShownLight::measure(const lightfield::LightField& scene) const {
  return sensor::coded_intensities(codes_, scene);
}

void ShownLight::image(const capture::CodedIntensities& intensities, ShownPattern shown,
                       std::vector<float>& light) const {
  const auto open = intensities.image(shown.code), full = intensities.image(intensities.count - 1);
  light.resize(open.size());
  parallel_for(light.size(), kLeastPixels, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const float passed = std::max(open[i], 0.0F) * (shown.code == 0 ? 1.0F : transmission_[shown.code - 1][i]);
      const float all = std::max(full[i], 0.0F), closed = all - std::max(open[i], 0.0F);
      light[i] = gain_ * (shown.is_inverse ? std::max(all - passed, 0.0F) : passed + leak_ * closed);
    }
  });
}

bool ShownLight::is_black(ShownPattern shown) const {
  const auto pattern = codes_.pattern(shown.code);
  const float closed = shown.is_inverse ? 1.0F : 0.0F;
  return std::all_of(pattern.begin(), pattern.end(), [=](float cell) { return cell == closed; });
}

}  // namespace e2lf::streams
