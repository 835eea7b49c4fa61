// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/capture/profile/sensor_constants.h"
#include "e2lf/capture/profile/sensor_profile.h"

namespace e2lf::streams {

/// The models that turn light into individual events.
enum class StreamModel {
  kQuantised,       ///< Eq. 8: events of a pattern count from the light at the end of the previous one
  kReferenceAware,  ///< Eq. 9, 10: a pixel remembers the log intensity of its last event
  kEsim,            ///< crossings found by linear interpolation of the log intensity
  kV2e,             ///< frame by frame: lin-log, low pass, mismatched thresholds, leak, shot noise
  kPixel,           ///< photoreceptor, amplifier, mismatched thresholds, noise: capture::PixelConstants
};

/// Parses "quantised", "reference-aware", "esim", "v2e" or "pixel". Fails with kInvalidValue for any other name.
[[nodiscard]] Result<StreamModel> stream_model_from_name(const std::string& name);
[[nodiscard]] const char* stream_model_name(StreamModel model);

/// The parameters of v2e, with the names and defaults of its command line.
struct V2eOptions {
  float pos_thres = 0.2F, neg_thres = 0.2F;  ///< mean thresholds, in natural logarithm
  float sigma_thres = 0.03F;                 ///< their standard deviation from pixel to pixel
  float cutoff_hz = 300.0F;                  ///< cutoff of the low pass in white light; 0 = no low pass
  float leak_rate_hz = 0.01F;                ///< ON events per pixel in constant light
  float leak_jitter_fraction = 0.1F;         ///< variation of the leak from frame to frame
  float noise_rate_cov_decades = 0.1F;       ///< spread of the leak from pixel to pixel
  float shot_noise_rate_hz = 0.001F;         ///< rate of both signs together, in the dark
  float refractory_period_s = 0.0005F;
  int64_t frame_us = 500;  ///< frame interval; v2e calls it timestamp_resolution
};

/// Returns the preset "noisy", "clean" or "default" of v2e. Fails with kInvalidValue for any other name.
[[nodiscard]] Result<V2eOptions> v2e_preset(const std::string& name);

/// Properties of a pixel of the model kPixel in addition to capture::PixelConstants. By default, there are none.
struct PixelDefects {
  double refractory_us = 0;  ///< blind time after an event, after which the pixel restarts from its level
  double leak_rate_hz = 0;   ///< ON events per pixel in constant light, due to a sinking reference
  double shot_rate_hz = 0;   ///< spurious events of either sign in the dark; decreases as eps / (I + eps)
  double hot_share = 0;      ///< share of pixels that fire permanently
  double hot_rate_hz = 1000;
};

/// The limited event rate of the readout. Events wait, and are lost if they would wait too long.
struct ReadoutLimit {
  double events_per_s = 0;   ///< 0 = no limit; 1.066e9 for a Prophesee EVK4
  double longest_us = 1000;  ///< an event that would wait longer is lost
};

struct StreamOptions {
  StreamModel model = StreamModel::kReferenceAware;
  /// For the models of the paper. kEsim uses eps, tau for both thresholds, and sigma_z for their spread from segment to
  /// segment.
  capture::SensorConstants constants = {};
  double esim_refractory_us = 0;
  V2eOptions v2e = {};
  capture::PixelConstants pixel = {};
  PixelDefects defects = {};
  ReadoutLimit readout = {};
  uint64_t seed = 0;      ///< seed of the noise
  uint64_t map_seed = 0;  ///< seed of the constant properties of a pixel: its thresholds and whether it is hot
};

/// Checks the options. Fails with kInvalidValue, naming the one that is not finite or out of range.
[[nodiscard]] Result<void> validate(const StreamOptions& options);

/// Returns the stream options for a camera file: its event model and constants. `seed` identifies a capture and also
/// selects the map of pixel properties.
[[nodiscard]] StreamOptions camera_stream(const capture::SensorProfile& camera, uint64_t seed);

}  // namespace e2lf::streams
