// SPDX-License-Identifier: MIT
#include "e2lf/sensor/event_model.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "e2lf/base/log.h"
#include "e2lf/base/rng.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/sensor/block_kernels.h"
#include "e2lf/sensor/pixel_model.h"

namespace e2lf::sensor {

Result<void> check_fit(const capture::Codes& codes, const LightFieldView& light_field) {
  const lightfield::Shape shape = lightfield::shape_of(light_field);
  if (shape.channels != 1) {
    return fail(ErrorCode::kShape, "", "the light field has ", shape.channels, " channels; convert it to grey first");
  }
  if (codes.views_y != shape.views_y || codes.views_x != shape.views_x) {
    return fail(ErrorCode::kShape, "", "the codes are for ", codes.views_y, "x", codes.views_x,
                " views, but the light field has ", shape.views_y, "x", shape.views_x,
                "; use codes for this number of views");
  }
  return {};
}

void code_block(const capture::Codes& codes, const LightFieldView& light_field, size_t first, size_t count, float* sums,
                size_t stride) {
  const lightfield::Shape shape = lightfield::shape_of(light_field);
  for (size_t n = 0; n < codes.num_patterns; ++n) std::fill_n(sums + n * stride, count, 0.0F);
  std::vector<float> scratch;
  for (size_t view = 0; view < shape.num_views(); ++view) {
    // Learned patterns are mostly closed, so that views blocked by all patterns are never read.
    const float* values = nullptr;
    for (size_t n = 0; n < codes.num_patterns; ++n) {
      const float weight = codes.pattern(n)[view] / static_cast<float>(shape.num_views());
      if (weight == 0) continue;
      if (values == nullptr) {
        values = light_field[view / shape.views_x][view % shape.views_x].values(scratch, first, count).data();
      }
      add_scaled(values, weight, sums + n * stride, count);
    }
  }
}

Result<CodedIntensities> coded_intensities(const capture::Codes& codes, const LightFieldView& light_field) {
  E2LF_RETURN_IF_ERROR(check_fit(codes, light_field));
  const lightfield::Shape shape = lightfield::shape_of(light_field);
  CodedIntensities intensities(codes.num_patterns, shape.height, shape.width);
  const size_t num_pixels = intensities.image_size();
  for_block_ranges(num_pixels, [&](size_t begin, size_t end) {
    for (size_t block = begin; block < end; ++block) {
      const size_t first = block * kBlockPixels;
      code_block(codes, light_field, first, std::min(kBlockPixels, num_pixels - first),
                 intensities.values.data() + first, num_pixels);
    }
  });
  return intensities;
}

namespace {

using capture::kLensPixels;

Result<CodedIntensities> lens_array_image(const LightFieldView& light_field) {
  const lightfield::Shape shape = lightfield::shape_of(light_field);
  if (shape.views_y != kLensPixels || shape.views_x != kLensPixels || shape.channels != 1) {
    return fail(ErrorCode::kShape, "", "a lens array requires 8x8 grey views, but the light field has ", shape.views_y,
                "x", shape.views_x, " of ", shape.channels, " channels; convert it first");
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
          const auto row = light_field[view / kLensPixels][view % kLensPixels][j];
          for (size_t i = left; i < right; ++i) sum += row[i][0];
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
                                        const LightFieldView& light_field, const ImageOptions& options) {
  for (const auto& [name, value] : {std::pair("gain", options.gain), std::pair("noise", options.sigma)}) {
    if (std::isfinite(value) && value >= 0.0F) continue;
    return fail(ErrorCode::kInvalidValue, "", "the ", name, " of intensity images is ", value, "; use zero or more");
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
Result<capture::EventImages> simulate_blocks(const ImageSize& size, const EventModelOptions& options,
                                             const Load& load) {
  E2LF_RETURN_IF_ERROR(validate(options));
  E2LF_RETURN_IF_ERROR(check_size(size));
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
  return simulate_blocks(size, options, [&](size_t first, size_t count, float* sums) {
    for (size_t n = 0; n < size.num_patterns; ++n) {
      std::memcpy(sums + n * kBlockPixels, intensities.image(n).data() + first, count * sizeof(float));
    }
  });
}

Result<capture::EventImages> simulate_events(const capture::Codes& codes, const LightFieldView& light_field,
                                             const EventModelOptions& options) {
  const ImageSize size = {codes.num_patterns, light_field.extents[2], light_field.extents[3]};
  E2LF_RETURN_IF_ERROR(check_fit(codes, light_field));
  return simulate_blocks(size, options, [&](size_t first, size_t count, float* sums) {
    code_block(codes, light_field, first, count, sums, kBlockPixels);
  });
}

}  // namespace e2lf::sensor
