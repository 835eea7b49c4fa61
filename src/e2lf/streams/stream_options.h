// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/capture/profile/camera.h"
#include "e2lf/capture/profile/sensor_constants.h"

namespace e2lf::streams {

/// How a pixel turns light into events one by one.
enum class StreamModel {
  kQuantised,       ///< Eq. 8: in each pattern counted from the light at the end of the one before
  kReferenceAware,  ///< Eq. 9, 10: a pixel remembers the log intensity of its last event
  kEsim,            ///< crossings found by linear interpolation of the log intensity
  kV2e,             ///< frame by frame: lin-log, low pass, unequal thresholds, leak, shot noise
  kPixel,           ///< photoreceptor, amplifier, unequal thresholds, noise: capture::PixelConstants
};

/// From "quantised", "reference-aware", "esim", "v2e" or "pixel". Fails with kInvalidValue.
[[nodiscard]] Result<StreamModel> stream_model_from_name(const std::string& name);
[[nodiscard]] const char* stream_model_name(StreamModel model);

/// The parameters of v2e under the names and with the defaults of its command line.
struct V2eOptions {
  float pos_thres = 0.2F, neg_thres = 0.2F;  ///< mean thresholds, natural logarithm
  float sigma_thres = 0.03F;                 ///< their standard deviation from pixel to pixel
  float cutoff_hz = 300.0F;                  ///< of the low pass in white light; 0 = none
  float leak_rate_hz = 0.01F;                ///< ON events of a pixel in constant light
  float leak_jitter_fraction = 0.1F;         ///< of the leak from frame to frame
  float noise_rate_cov_decades = 0.1F;       ///< spread of the leak from pixel to pixel
  float shot_noise_rate_hz = 0.001F;         ///< of both signs together in the dark
  float refractory_period_s = 0.0005F;
  int64_t frame_us = 500;  ///< from frame to frame; v2e calls it timestamp_resolution
};

/// v2e's presets "noisy" and "clean", and "default". Fails with kInvalidValue.
[[nodiscard]] Result<V2eOptions> v2e_preset(const std::string& name);

/// What a pixel of the model kPixel does beside capture::PixelConstants. Nothing of it by default.
struct PixelDefects {
  double refractory_us = 0;  ///< after an event a pixel is blind for so long, then starts from the level it has
  double leak_rate_hz = 0;   ///< ON events of a pixel in constant light: its reference sinks
  double shot_rate_hz = 0;   ///< events of either sign that nothing caused, in the dark; falls as eps / (I + eps)
  double hot_share = 0;      ///< of the pixels, that fire all the time
  double hot_rate_hz = 1000;
};

/// The sensor hands out so many events per second; others wait, and are lost when they wait too long.
struct ReadoutLimit {
  double events_per_s = 0;   ///< 0 = no limit; 1.066e9 for a Prophesee EVK4
  double longest_us = 1000;  ///< an event that would wait longer is lost
};

struct StreamOptions {
  StreamModel model = StreamModel::kReferenceAware;
  /// Of the paper's models. For kEsim eps, both thresholds (tau) and their spread from segment to segment (sigma_z).
  capture::SensorConstants constants = {};
  double esim_refractory_us = 0;
  V2eOptions v2e = {};
  capture::PixelConstants pixel = {};
  PixelDefects defects = {};
  ReadoutLimit readout = {};
  uint64_t seed = 0;      ///< of noise
  uint64_t map_seed = 0;  ///< of what stays with a pixel: its thresholds, whether it is hot
};

/// Success when the options are usable. Fails with kInvalidValue, naming the one that is not finite or out of range.
[[nodiscard]] Result<void> validate(const StreamOptions& options);

}  // namespace e2lf::streams
