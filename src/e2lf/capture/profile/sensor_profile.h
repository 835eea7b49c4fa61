// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/choice.h"
#include "e2lf/base/result.h"
#include "e2lf/files/options.h"

namespace e2lf::capture {

/// The constants of the paper's event sensor (Eq. 3 and 8). The defaults are those of a Prophesee EVK4. Intensities are
/// normalised by the number of views.
struct SensorConstants {
  float eps = 0.01F;       ///< dark level added to the intensity
  float tau = 0.30F;       ///< contrast threshold, natural logarithm
  float sigma_w = 0.175F;  ///< standard deviation of the log-intensity noise
  float sigma_z = 0.04F;   ///< standard deviation of the threshold
  float sigma_i = 0.005F;  ///< standard deviation of the noise of intensity images, if they are measured

  bool operator==(const SensorConstants&) const = default;
};

/// The paper's models of how a pixel generates events.
enum class EventModel {
  kQuantised,       ///< Eq. 8: events are counted from the coded intensity before the transition
  kReferenceAware,  ///< Eq. 9 and 10: each pixel stores the log intensity of its last event as its reference
};

/// The names of the event models in files and options.
inline constexpr Choice<EventModel> kEventModels[] = {{"quantised", EventModel::kQuantised},
                                                      {"reference-aware", EventModel::kReferenceAware}};

[[nodiscard]] constexpr const char* event_model_name(EventModel model) {
  return word_of(model, kEventModels);
}

/// How the grid of views is oriented relative to the aperture patterns. A lens turns the aperture by 180 degrees
/// against the image, and a mirror flips one axis. Disparities along a flipped axis have the wrong sign until the views
/// are reordered. The images themselves are unchanged.
struct Orientation {
  bool flip_x = false;  ///< view (r, c) belongs at (r, views_x - 1 - c)
  bool flip_y = false;  ///< view (r, c) belongs at (views_y - 1 - r, c)

  [[nodiscard]] bool is_upright() const { return !flip_x && !flip_y; }
  /// Returns the combination of two orientations. Each orientation is its own inverse.
  [[nodiscard]] Orientation operator+(const Orientation& other) const {
    return {flip_x != other.flip_x, flip_y != other.flip_y};
  }
  bool operator==(const Orientation&) const = default;
};

/// The grid of views is turned by 180 degrees.
inline constexpr Orientation kTurned{true, true};

/// Returns "upright", "turned", "flipped-x" or "flipped-y": the value of "views" in camera files, schedule files, event
/// images and run records.
[[nodiscard]] const char* orientation_name(const Orientation& orientation);
/// Parses such a name. Fails with kInvalidValue.
[[nodiscard]] Result<Orientation> orientation_from_name(const std::string& name, const std::string& location);

/// The constants of an event pixel behind a coded aperture, one number each.
enum class PixelConstant : uint8_t {
  kEps,            ///< dark level, in units of the light field's intensity
  kReceptorRate,   ///< bandwidth of the photoreceptor in 1/s, per unit of (I + eps) / eps
  kAmplifierRate,  ///< bandwidth of the amplifier that follows the photoreceptor, 1/s
  kLeak,           ///< fraction of the light that a closed cell transmits
  kThresholdOn,    ///< contrast threshold of ON events, natural logarithm
  kThresholdOff,   ///< contrast threshold of OFF events
  kMismatch,       ///< relative standard deviation over the pixels of a factor that is common to both thresholds
  kMismatchEach,   ///< relative standard deviation of an independent factor of each threshold
  kNoise,          ///< standard deviation of the log intensity at the end of a pattern
  kShotNoise,      ///< additional standard deviation in the dark; decreases with the square root of (I + eps) / eps
  kResetSpan,      ///< after black, the reference lies up to this many OFF thresholds above the level; 1 without noise
  kResetOffset,    ///< and lower by this offset, natural logarithm
  kDarkOff,        ///< fraction of pixels with a spurious OFF event per pattern, in the dark
  kDarkOn,         ///< fraction of pixels with a spurious ON event per pattern, in the dark
  kBlackTime,      ///< duration of the black pattern, s
  kLitTime,        ///< duration of each active pattern, s
};
inline constexpr size_t kNumPixelConstants = 16;

/// Returns the key of a constant in a camera file: "eps", "receptor_rate_hz", ...
[[nodiscard]] const char* pixel_constant_key(PixelConstant constant);

/// One value for each constant.
struct PixelConstants {
  std::array<float, kNumPixelConstants> values = {};

  [[nodiscard]] float& operator[](PixelConstant constant) { return values[static_cast<size_t>(constant)]; }
  [[nodiscard]] float operator[](PixelConstant constant) const { return values[static_cast<size_t>(constant)]; }
  bool operator==(const PixelConstants&) const = default;
};

/// The lower limit of the threshold of a pixel, relative to the mean over the pixels.
inline constexpr double kLeastThreshold = 0.3;
/// The largest distance of the reference of a pixel from its signal at which no event is due, in thresholds.
inline constexpr double kAlmostThreshold = 0.999;

/// The profile of a sensor: its event model, and the constants of its pixels with their uncertainties.
struct SensorProfile {
  std::string name = "paper";
  std::string event_model = "reference-aware";  ///< "reference-aware", "quantised" or "pixel"
  SensorConstants
      constants;  ///< constants of the paper's event models; for "pixel", only eps and the mean threshold are set
  PixelConstants pixel;        ///< constants of the event model "pixel"
  PixelConstants uncertainty;  ///< relative uncertainty of each: the true value is within a factor of 1 -+ this
  /// Transmission of patterns 2, 3, ...: the light that each passes relative to its open cells. Absent values are 1.
  std::vector<float> transmission;
  float transmission_uncertainty = 0.0F;
  /// Variation of the transmissions over the image, for the same patterns; see transmission_at(). Absent values are 0.
  std::vector<float> transmission_slope_x, transmission_slope_y;
  std::optional<Orientation> views = {};  ///< orientation of the views; empty if it is not known

  [[nodiscard]] bool is_pixel() const { return event_model == "pixel"; }
};

/// Computes the transmission of active pattern n (0 is the second pattern) at a point of the image: transmission *
/// exp(slope_x * x + slope_y * y). The centre of the image is (0, 0) and the middle of its right edge is (1, 0); y has
/// the same unit.
[[nodiscard]] float transmission_at(const SensorProfile& camera, size_t n, float x, float y);

/// Reads or writes a sensor profile as a camera file: {"name", "event_model", "constants": {"<key>": {"value",
/// "uncertainty", "source"}, ...}, "transmission": {"value": [..], "slope_x": [..], "slope_y": [..], "uncertainty",
/// "source"}, "views": "turned" (see orientation_name)}. A camera of the paper's models has the keys eps, tau, sigma_w
/// and sigma_z; one of "pixel" has all keys of pixel_constant_key(). Reading fails with kNotFound, kFormat and
/// kInvalidValue (unknown or missing keys, or values that are not finite or out of range), naming the key.
[[nodiscard]] Result<SensorProfile> read_camera(const std::filesystem::path& path);
[[nodiscard]] Result<SensorProfile> camera_from_json(const Json& json, const std::string& location);
[[nodiscard]] Json to_json(const SensorProfile& camera);

/// Returns the profile without anything random between cycles: noise and events in the dark are set to 0.
[[nodiscard]] SensorProfile without_noise(SensorProfile camera);

/// Lengths of the conditioning vector, whose numbers lie approximately in [-1, 1]; see conditioning_vector().
inline constexpr size_t kNumFixedConditions = 16;
/// The place of the number of cycles in it, and the element for counts that are averaged over `cycles` >= 1.
inline constexpr size_t kCyclesCondition = kNumFixedConditions - 1;
[[nodiscard]] inline float cycles_condition(float cycles) {
  return 0.25F * std::log2(cycles);
}
[[nodiscard]] inline size_t conditioning_size(size_t num_patterns) {
  return kNumFixedConditions + num_patterns - 2;
}

/// What the conditioning vector of one training sample or one recording is computed from.
struct ConditioningSource {
  bool pixel = false;         ///< whether the event model is "pixel"
  SensorConstants constants;  ///< constants of the paper's models
  float residue = 0.0F;  ///< in the paper's models, references start up to this many thresholds above the black level
  PixelConstants values = {};                ///< constants of the event model "pixel"
  std::span<const float> transmission = {};  ///< transmissions of patterns 2, 3, ...
  size_t cycles = 1;                         ///< number of cycles over which the counts are averaged
};

/// Computes the conditioning vector, conditioning_size(num_patterns) numbers: a flag for "pixel", thresholds, noise,
/// mismatch, residue, lag of the photoreceptor and of the amplifier (0 is none), leak, events in the dark, number of
/// cycles, and the transmissions of patterns 3, 4, ... relative to that of pattern 2. Constants that an event model
/// does not have are 0 wherever this describes an ideal sensor.
[[nodiscard]] std::vector<float> conditioning_vector(const ConditioningSource& source, size_t num_patterns);

/// Computes the conditioning vector of a camera at its stated values, for counts that are averaged over `cycles`.
[[nodiscard]] std::vector<float> conditioning_vector(const SensorProfile& camera, size_t num_patterns,
                                                     size_t cycles = 1);

}  // namespace e2lf::capture
