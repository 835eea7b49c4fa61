// SPDX-License-Identifier: MIT
#include "e2lf/recon/event_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/sensor/pixel_model.h"

namespace e2lf::recon {
namespace {

constexpr size_t kResidueParts = 5;  // number of residues from 0 to 1 thresholds
using Differences = std::array<uint64_t, kResidueParts>;

/// Returns the camera without noise and mismatch, and with the mean reference after black.
capture::SensorProfile average_pixels(capture::SensorProfile camera) {
  using enum capture::PixelConstant;
  camera = capture::without_noise(std::move(camera));
  camera.pixel[kMismatch] = camera.pixel[kMismatchEach] = 0.0F;
  camera.pixel[kResetOffset] -= 0.5F * camera.pixel[kResetSpan] * camera.pixel[kThresholdOff];
  camera.pixel[kResetSpan] = 0.0F;
  return camera;
}

Result<EventError> pixel_error(const EventCheck& check, const LightFieldView& light_field, float gain,
                               const PlanesView<const int16_t>& given) {
  E2LF_ASSIGN_OR_RETURN(
      const capture::EventImages counted,
      sensor::simulate_pixel_events(check.codes, light_field, average_pixels(*check.pixels), {.gain = 1.0F / gain}));
  const auto cycles = static_cast<int>(check.cycles);
  uint64_t sum = 0;
  for (size_t i = 0; i < given.size(); ++i) {
    sum += static_cast<uint64_t>(std::abs(cycles * int{counted.values[i]} - int{given.value(i)}));
  }
  const double mean = static_cast<double>(sum) / static_cast<double>(given.size() * check.cycles);
  return EventError{.at_first = mean, .least = mean};
}

}  // namespace

Result<EventError> event_error(const EventCheck& check, const LightFieldView& light_field, float gain,
                               const PlanesView<const int16_t>& given) {
  if (check.codes.num_patterns != given.extents[0] + 1) {
    return fail(ErrorCode::kShape, "", "the codes have ", check.codes.num_patterns, " patterns, the events ",
                given.extents[0], " transitions; give the codes with which the events were recorded");
  }
  if (light_field.extents[2] != given.extents[1] || light_field.extents[3] != given.extents[2]) {
    return fail(ErrorCode::kShape, "", "the light field and the events differ in size");
  }
  if (check.pixels) return pixel_error(check, light_field, gain, given);
  E2LF_ASSIGN_OR_RETURN(const auto intensities, sensor::coded_intensities(check.codes, light_field));
  constexpr size_t kMinPixels = size_t{1} << 14;
  std::mutex mutex;
  Differences differences{};
  const float inverse_gain = 1.0F / gain, eps = check.constants.eps, tau = check.constants.tau;
  const auto cycles = static_cast<int>(check.cycles);
  const bool is_reference_aware = check.model == sensor::EventModel::kReferenceAware;
  parallel_for(intensities.image_size(), kMinPixels, [&](size_t begin, size_t end) {
    Differences own{};
    std::vector<float> levels(intensities.count);  // the log intensities of a pixel, which are those of all residues
    for (size_t pixel = begin; pixel < end; ++pixel) {
      for (size_t k = 0; k < levels.size(); ++k) {
        levels[k] = std::log(std::max(inverse_gain * intensities.image(k)[pixel], 0.0F) + eps);
      }
      for (size_t part = 0; part < kResidueParts; ++part) {
        float reference = levels[0] + tau * static_cast<float>(part) / (kResidueParts - 1);
        for (size_t k = 1; k < levels.size(); ++k) {
          const auto count = static_cast<int>((levels[k] - reference) / tau);
          own[part] += static_cast<uint64_t>(std::abs(cycles * count - int{given[k - 1].value(pixel)}));
          reference = is_reference_aware ? reference + tau * static_cast<float>(count) : levels[k];
        }
      }
    }
    const std::lock_guard<std::mutex> lock(mutex);
    for (size_t part = 0; part < kResidueParts; ++part) differences[part] += own[part];
  });

  const auto mean = [&](uint64_t sum) {
    return static_cast<double>(sum) / static_cast<double>(given.size() * check.cycles);
  };
  const auto least = std::min_element(differences.begin(), differences.end());
  return EventError{mean(differences[0]), mean(*least),
                    static_cast<double>(least - differences.begin()) / static_cast<double>(kResidueParts - 1)};
}

}  // namespace e2lf::recon
