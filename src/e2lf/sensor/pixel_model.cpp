// SPDX-License-Identifier: MIT
#include "e2lf/sensor/pixel_model.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <vector>

#include "e2lf/base/log.h"
#include "e2lf/base/rng.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/sensor/event_model.h"

namespace e2lf::sensor {
namespace {

using enum capture::PixelConstant;

constexpr size_t kRowPixels = 1024;  // the size of a piece of work

/// The patterns of a cycle that begins with black.
struct ShownCycle {
  capture::Codes codes;   ///< a1 to aN
  bool is_whole = false;  ///< they are followed by their inverses and by black again
  [[nodiscard]] size_t num_patterns() const { return is_whole ? 2 * codes.num_patterns + 1 : codes.num_patterns; }
  /// The black pattern and its inverse are shown longer than the others.
  [[nodiscard]] capture::PixelConstant time_of(size_t n) const {
    return n % codes.num_patterns == 0 ? kBlackTime : kLitTime;
  }
  [[nodiscard]] bool is_last_black(size_t n) const { return n == 2 * codes.num_patterns; }
};

ShownCycle shown_cycle(const capture::Codes& codes) {
  auto shown = capture::codes_of_whole_cycle(codes);
  const bool is_whole = shown.has_value();
  return {is_whole ? *std::move(shown) : codes, is_whole};
}

/// The light on a pixel in each pattern, J = (I + eps) / eps.
struct Exposure {
  std::vector<float> of_patterns;  ///< from black on
  std::vector<float> of_inverses;  ///< of the codes
};

/// The state of one pixel from the inverse of the last pattern to the end of the cycle.
class Pixel {
 public:
  Pixel(const capture::PixelConstants& constants, PixelThresholds thresholds, float intensity)
      : constants_(constants), thresholds_(thresholds), inverse_level_(1.0F / intensity), level_(std::log(intensity)) {}

  void follow(float intensity, float seconds) {
    const float target = 1.0F / intensity;
    inverse_level_ = target + (inverse_level_ - target) * std::exp(-constants_[kReceptorRate] * seconds * intensity);
    const float log_intensity = -std::log(inverse_level_);
    level_ = log_intensity + (level_ - log_intensity) * std::exp(-constants_[kAmplifierRate] * seconds);
  }

  /// Sets the reference to where the change to black leaves it; `draw` is uniform in 0..1.
  void settle(float draw) {
    reference_ = level_ + thresholds_.off * constants_[kResetSpan] * draw - constants_[kResetOffset];
  }

  /// Returns the signed events of the change to black, in which noise lowers the reference along with the level.
  float count_events_to_black() { return compare(level_ - constants_[kResetOffset]); }

  /// Returns the signed events of one transition.
  float count_events(float intensity, const std::array<uint32_t, 4>& words) {
    const float noise = std::sqrt(constants_[kNoise] * constants_[kNoise] +
                                  constants_[kShotNoise] * constants_[kShotNoise] / intensity);
    float count = compare(level_ + noise * normals_of(words[0], words[1])[0]);
    const float draw = uniform_of(words[2]) * intensity;
    if (draw < constants_[kDarkOff]) {
      count -= 1.0F;
      reference_ -= thresholds_.off;
    }
    if (intensity - draw < constants_[kDarkOn]) {
      count += 1.0F;
      reference_ += thresholds_.on;
    }
    return count;
  }

 private:
  float compare(float level) {
    const float difference = level - reference_;
    const float threshold = difference > 0.0F ? thresholds_.on : thresholds_.off;
    const float count = std::trunc(difference / threshold);
    reference_ += threshold * count;
    return count;
  }

  const capture::PixelConstants& constants_;
  PixelThresholds thresholds_;
  float inverse_level_, level_, reference_ = 0.0F;
};

/// The transmission of the active patterns at each place of the picture, as the product of a factor per column and one
/// per row.
class TransmissionMap {
 public:
  TransmissionMap(const capture::SensorProfile& camera, size_t num_lit, size_t height, size_t width) : width_(width) {
    const float middle_x = 0.5F * static_cast<float>(width), middle_y = 0.5F * static_cast<float>(height);
    for (size_t n = 0; n < num_lit; ++n) {
      const float middle = capture::transmission_at(camera, n, 0.0F, 0.0F);
      auto& column = columns_.emplace_back(width);
      auto& row = rows_.emplace_back(height);
      for (size_t x = 0; x < width; ++x) {
        column[x] = capture::transmission_at(camera, n, (static_cast<float>(x) + 0.5F) / middle_x - 1.0F, 0.0F);
      }
      for (size_t y = 0; y < height; ++y) {
        const float place = (static_cast<float>(y) + 0.5F - middle_y) / middle_x;
        row[y] = capture::transmission_at(camera, n, 0.0F, place) / middle;
      }
    }
  }

  [[nodiscard]] float at(size_t n, size_t pixel) const {
    return columns_[n][pixel % width_] * rows_[n][pixel / width_];
  }

 private:
  size_t width_;
  std::vector<std::vector<float>> columns_, rows_;
};

Result<void> check(const capture::Codes& codes, const capture::SensorProfile& camera,
                   const PixelModelOptions& options) {
  if (!camera.is_pixel()) {
    return fail(ErrorCode::kInvalidValue, "", "the camera \"", camera.name, "\" has the event model ",
                camera.event_model, ", not pixel; use another camera, or simulate its model");
  }
  if (!(options.gain >= 0.0F) || !std::isfinite(options.gain)) {
    return fail(ErrorCode::kInvalidValue, "", "a gain of ", options.gain,
                " is not valid; use a finite number of at least 0");
  }
  if (codes.num_patterns < 2 || !capture::is_black_first(codes)) {
    return fail(ErrorCode::kShape, "", "the event model pixel requires patterns that begin with black; use others");
  }
  return {};
}

}  // namespace

PixelThresholds draw_thresholds(const capture::PixelConstants& constants, uint64_t map_seed, uint64_t pixel) {
  const auto words = CounterRng(map_seed, kThresholdStream).bits(pixel);
  constexpr auto kLeast = static_cast<float>(capture::kLeastThreshold);
  const auto [both, on] = normals_of(words[0], words[1]);
  const float off = normals_of(words[2], words[3])[0];
  const auto factor = [&, both = both](float own) {
    return std::max(1.0F + constants[kMismatch] * both + constants[kMismatchEach] * own, kLeast);
  };
  return {constants[kThresholdOn] * factor(on), constants[kThresholdOff] * factor(off)};
}

Result<capture::EventImages> simulate_pixel_events(const capture::Codes& codes, const LightFieldView& light_field,
                                                   const capture::SensorProfile& camera,
                                                   const PixelModelOptions& options) {
  E2LF_RETURN_IF_ERROR(check(codes, camera, options));
  const ShownCycle cycle = shown_cycle(codes);
  E2LF_ASSIGN_OR_RETURN(const CodedIntensities intensities,
                        coded_intensities(capture::with_open_aperture(cycle.codes), light_field));
  const capture::PixelConstants& constants = camera.pixel;
  const size_t num_codes = cycle.codes.num_patterns;
  const TransmissionMap transmission(camera, num_codes - 1, intensities.height, intensities.width);
  const float gain_over_eps = options.gain / constants[kEps], leak = constants[kLeak];
  // The light through a pattern is that of its open cells, plus the leak of the others; through an inverse, it is the
  // light of the open aperture that its code blocks.
  const auto expose = [&](size_t pixel, Exposure& exposure) {
    const auto value = [&](size_t n) { return std::max(intensities.image(n)[pixel], 0.0F) * gain_over_eps; };
    const float full = value(num_codes);
    exposure.of_patterns.clear();
    exposure.of_inverses.clear();
    for (size_t n = 0; n < num_codes; ++n) {
      const float open = value(n);
      const float passed = open * (n == 0 ? 1.0F : transmission.at(n - 1, pixel));
      exposure.of_patterns.push_back(passed + leak * (full - open) + 1.0F);
      exposure.of_inverses.push_back(std::max(full - passed, 0.0F) + 1.0F);
    }
    if (!cycle.is_whole) return;
    exposure.of_patterns.insert(exposure.of_patterns.end(), exposure.of_inverses.begin(), exposure.of_inverses.end());
    exposure.of_patterns.push_back(exposure.of_patterns.front());
  };
  capture::EventImages images(cycle.num_patterns() - 1, intensities.height, intensities.width);
  std::atomic<bool> is_saturated = false;
  parallel_for(images.image_size(), kRowPixels, [&](size_t begin, size_t end) {
    Exposure exposure;
    for (size_t p = begin; p < end; ++p) {
      expose(p, exposure);
      Pixel pixel(constants, draw_thresholds(constants, options.map_seed, p), exposure.of_inverses.back());
      pixel.follow(exposure.of_patterns[0], constants[kBlackTime]);
      pixel.settle(uniform_of(CounterRng(options.seed, 0).bits(p)[0]));
      for (size_t n = 1; n < cycle.num_patterns(); ++n) {
        pixel.follow(exposure.of_patterns[n], constants[cycle.time_of(n)]);
        const float count = cycle.is_last_black(n)
                                ? pixel.count_events_to_black()
                                : pixel.count_events(exposure.of_patterns[n], CounterRng(options.seed, n).bits(p));
        const float held = std::clamp(count, -32768.0F, 32767.0F);
        if (held != count) is_saturated = true;
        images.image(n - 1)[p] = static_cast<int16_t>(held);
      }
    }
  });
  if (is_saturated)
    log_warning("event counts reached the limits of int16 and were saturated; check the camera's constants");
  return images;
}

}  // namespace e2lf::sensor
