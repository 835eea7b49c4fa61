// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/profile/orientation.h"
#include "e2lf/capture/profile/sensor_constants.h"
#include "e2lf/files/options.h"

namespace e2lf::capture {

/// The constants of an event pixel behind a switched aperture, one number each.
enum class PixelConstant : uint8_t {
  kEps,            ///< dark level, in units of the light field's intensity
  kReceptorRate,   ///< of the photoreceptor: 1/s for each unit of (I + eps) / eps
  kAmplifierRate,  ///< of the amplifier behind it, 1/s
  kLeak,           ///< share of the light that a closed cell passes
  kThresholdOn,    ///< contrast threshold of ON events, natural logarithm
  kThresholdOff,   ///< of OFF events
  kMismatch,       ///< standard deviation of both thresholds of a pixel, relative; fixed per pixel
  kMismatchEach,   ///< the same for each threshold on its own
  kNoise,          ///< standard deviation of the log intensity at the end of a pattern
  kShotNoise,      ///< the same in the dark; falls with the root of (I + eps) / eps
  kResetSpan,      ///< the reference after black lies up to this many OFF thresholds above the level; 1 without noise
  kResetOffset,    ///< and by this much below that, natural logarithm
  kDarkOff,        ///< share of pixels with an OFF event that nothing caused, per pattern, in the dark
  kDarkOn,         ///< of ON events
  kBlackTime,      ///< how long black is shown, s
  kLitTime,        ///< how long each other pattern is shown, s
};
inline constexpr size_t kNumPixelConstants = 16;

/// The key of a constant in a camera file: "eps", "receptor_rate_hz", ...
[[nodiscard]] const char* pixel_constant_key(PixelConstant constant);

/// A value for each constant.
struct PixelConstants {
  std::array<float, kNumPixelConstants> values = {};

  [[nodiscard]] float& operator[](PixelConstant constant) { return values[static_cast<size_t>(constant)]; }
  [[nodiscard]] float operator[](PixelConstant constant) const { return values[static_cast<size_t>(constant)]; }
  bool operator==(const PixelConstants&) const = default;
};

/// What is known of a camera: how its pixels make events, each constant with how far it may be off.
struct SensorProfile {
  std::string name = "paper";
  std::string event_model = "reference-aware";  ///< or "quantised", "pixel"
  SensorConstants constants;                    ///< of the paper's models; for "pixel" eps and the mean threshold
  PixelConstants pixel;                         ///< of "pixel"
  PixelConstants uncertainty;                   ///< of each, relative: the truth is within a factor of 1 -+ this
  /// Light that each lit pattern passes relative to its open cells, for patterns 2, 3, ...; those behind the end: 1.
  std::vector<float> transmission;
  float transmission_uncertainty = 0.0F;
  /// How that changes over the field, for the same patterns; see transmission_at(). Those behind the end: 0.
  std::vector<float> transmission_slope_x, transmission_slope_y;
  std::optional<Orientation> views = {};  ///< how its views come out; nothing = not known

  [[nodiscard]] bool is_pixel() const { return event_model == "pixel"; }
};

/// Light that lit pattern n (0 = the second pattern) passes relative to its open cells at a place of the picture:
/// transmission * exp(slope_x * x + slope_y * y). The middle of the picture is (0, 0), the middle of its right edge
/// (1, 0), and y has the same unit.
[[nodiscard]] float transmission_at(const SensorProfile& camera, size_t n, float x, float y);

/// Reads a camera file: {"name", "event_model", "constants": {"<key>": {"value", "uncertainty", "source"}, ...},
/// "transmission": {"value": [..], "slope_x": [..], "slope_y": [..], "uncertainty", "source"}, "views": "turned" (see
/// orientation_name)}. A camera of the paper's models has the keys eps, tau, sigma_w and sigma_z, one of "pixel" all of
/// pixel_constant_key(). Fails with kNotFound, kFormat, kInvalidValue (unknown or missing keys, values that are not
/// finite or out of range), naming the key.
[[nodiscard]] Result<SensorProfile> read_camera(const std::filesystem::path& path);
[[nodiscard]] Result<SensorProfile> camera_from_json(const Json& json, const std::string& location);
[[nodiscard]] Json to_json(const SensorProfile& camera);

/// The same camera without anything random between cycles: noise and dark events are 0.
[[nodiscard]] SensorProfile without_noise(SensorProfile camera);

/// What a network is told of a camera, as numbers of about -1 to 1: see conditioning_vector().
inline constexpr size_t kNumFixedConditions = 16;
[[nodiscard]] inline size_t conditioning_size(size_t num_patterns) {
  return kNumFixedConditions + num_patterns - 2;
}

/// The camera in the form in which conditioning are made of it, for one sample of training or one recording.
struct ConditioningSource {
  bool pixel = false;          ///< "pixel" or one of the paper's models
  SensorConstants constants;   ///< of the paper's models
  float residue = 0.0F;        ///< of the paper's models: references start up to this many thresholds above black
  PixelConstants values = {};  ///< of "pixel"
  std::span<const float> transmission = {};  ///< for patterns 2, 3, ...
  size_t cycles = 1;                         ///< counts are means over so many cycles
};

/// The conditioning, conditioning_size(num_patterns) of them: a flag for "pixel", thresholds, noises, mismatch,
/// residue, how far photoreceptor and amplifier lag (0: not at all), leak, events in the dark, cycles, transmission of
/// patterns 3, 4,
/// ... relative to that of pattern 2. Constants that a model does not have are 0, where that means an ideal sensor.
[[nodiscard]] std::vector<float> conditioning_vector(const ConditioningSource& source, size_t num_patterns);

/// The conditioning of a camera at its stated values, for counts that are means over `cycles`.
[[nodiscard]] std::vector<float> conditioning_vector(const SensorProfile& camera, size_t num_patterns,
                                                     size_t cycles = 1);

}  // namespace e2lf::capture
