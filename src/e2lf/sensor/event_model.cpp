// SPDX-License-Identifier: MIT
#include "e2lf/sensor/event_model.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/sensor/block_kernels.h"

namespace e2lf::sensor {
namespace {

struct ImageSize {
  size_t num_patterns = 0, height = 0, width = 0;
};

Result<void> check_size(const ImageSize& size) {
  if (size.num_patterns < 2) {
    return fail(ErrorCode::kShape, "", size.num_patterns, " patterns have no transition; use at least two");
  }
  if (size.height * size.width > std::numeric_limits<uint32_t>::max()) {
    return fail(ErrorCode::kShape, "", "images of ", size.width, "x", size.height, " are too large; use smaller ones");
  }
  return {};
}

/// Simulates event images block by block. load(first, count, sums) must write the coded intensities of the pixels to
/// sums[n * kBlockPixels + i].
template <typename Load>
capture::EventImages simulate_blocks(const ImageSize& size, const EventModelOptions& options, const Load& load) {
  capture::EventImages images(size.num_patterns - 1, size.height, size.width);
  const size_t num_pixels = images.image_size();
  std::atomic<bool> saturated = false;
  for_block_ranges(num_pixels, [&](size_t begin, size_t end) {
    std::vector<float> intensities(size.num_patterns * kBlockPixels);
    std::vector<int16_t> counts(images.count * kBlockPixels);
    for (size_t block = begin; block < end; ++block) {
      const size_t first = block * kBlockPixels, count = std::min(kBlockPixels, num_pixels - first);
      load(first, count, intensities.data());
      const EventBlock task = {size.num_patterns, static_cast<uint32_t>(first), intensities.data(), counts.data()};
      if (simulate_block(task, count, options)) saturated = true;
      for (size_t k = 0; k < images.count; ++k) {
        std::memcpy(images.image(k).data() + first, counts.data() + k * kBlockPixels, count * sizeof(int16_t));
      }
    }
  });
  if (saturated) log_warning("event counts reached the limits of int16 and were saturated; check the sensor constants");
  return images;
}

}  // namespace

Result<EventModel> event_model_from_name(const std::string& name) {
  return choice_of(name, capture::kEventModels, "event model");
}

Result<void> validate(const EventModelOptions& options) {
  const auto check = [](const char* name, float value, bool positive) -> Result<void> {
    // The logarithm is inaccurate below the normal numbers.
    if (std::isfinite(value) && (positive ? value >= std::numeric_limits<float>::min() : value >= 0)) return {};
    return fail(ErrorCode::kInvalidValue, "", name, " is ", value, "; use a ",
                positive ? "positive number" : "number of at least 0");
  };
  E2LF_RETURN_IF_ERROR(check("eps", options.constants.eps, true));
  E2LF_RETURN_IF_ERROR(check("tau", options.constants.tau, true));
  E2LF_RETURN_IF_ERROR(check("sigma_w", options.constants.sigma_w, false));
  E2LF_RETURN_IF_ERROR(check("sigma_z", options.constants.sigma_z, false));
  E2LF_RETURN_IF_ERROR(check("gain", options.gain, false));
  if (options.residue >= 0.0F && options.residue <= 1.0F) return {};
  return fail(ErrorCode::kInvalidValue, "", "residue is ", options.residue, "; use a number from 0 to 1");
}

Result<capture::EventImages> simulate_events(const CodedIntensities& intensities, const EventModelOptions& options) {
  const ImageSize size = {intensities.count, intensities.height, intensities.width};
  E2LF_RETURN_IF_ERROR(validate(options));
  E2LF_RETURN_IF_ERROR(check_size(size));
  return simulate_blocks(size, options, [&](size_t first, size_t count, float* sums) {
    for (size_t n = 0; n < size.num_patterns; ++n) {
      std::memcpy(sums + n * kBlockPixels, intensities.image(n).data() + first, count * sizeof(float));
    }
  });
}

Result<capture::EventImages> simulate_events(const capture::Codes& codes, const LightFieldView& light_field,
                                             const EventModelOptions& options) {
  const ImageSize size = {codes.num_patterns, light_field.extents[2], light_field.extents[3]};
  E2LF_RETURN_IF_ERROR(validate(options));
  E2LF_RETURN_IF_ERROR(check_size(size));
  E2LF_RETURN_IF_ERROR(check_fit(codes, light_field));
  return simulate_blocks(size, options, [&](size_t first, size_t count, float* sums) {
    code_block(codes, light_field, first, count, sums, kBlockPixels);
  });
}

}  // namespace e2lf::sensor
