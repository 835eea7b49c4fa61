// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>

#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_constants.h"
#include "e2lf/learn/events/pixel_model.h"

namespace e2lf::learn {

using capture::EventModel;

/// Sensor constants per sample: float32 [batch, 1, 1] each, on the device of the light fields.
struct SampleConstants {
  torch::Tensor eps, tau, sigma_w, sigma_z;
  PixelSamples pixel = {};          ///< for samples of physical pixels; undefined tensors: there are none
  torch::Tensor conditioning = {};  ///< float32 [batch, capture::conditioning_size(N)]: what the network is told
};

/// The same constants for every sample; without conditioning.
[[nodiscard]] SampleConstants repeat_constants(const capture::SensorConstants& constants, int64_t batch,
                                               torch::Device device);

/// Returns one sample of a camera at its stated values, with conditioning, whose counts are means over `cycles`. Of
/// `num_codes` codes there are as many patterns, or 2 * num_codes + 1 in a whole cycle.
[[nodiscard]] SampleConstants sample_of(const capture::SensorProfile& camera, size_t num_patterns, size_t num_codes,
                                        size_t cycles, torch::Device device);

/// What ties patterns to each other.
enum class PatternTie {
  kNone,
  kBlackFirst,     ///< the first pattern is zero and has no parameters
  kComplementary,  ///< the second is the first inverted, the fourth the third, ...: together they open every cell alike
  kWholeCycle,     ///< capture::whole_cycle() of codes of which the first is black
};

/// Trainable aperture patterns sigmoid(scale * parameters).
class Patterns {
 public:
  /// Starts each pattern as a soft disc at a random place, from torch's generator. (From small white noise, all
  /// patterns see the same at first, and learning starts by closing every cell.) There is at least one with parameters;
  /// complementary patterns are even in number.
  Patterns(size_t num_patterns, PatternTie tie, torch::Device device);

  /// Starts from binary codes [n, views] instead, each cell softened alike; patterns beyond these start as before.
  void start_at(const torch::Tensor& codes);

  /// Starts from white noise of a given standard deviation instead.
  void start_at_noise(double width);

  /// [N, views] in [0, 1], differentiable. A growing scale drives the patterns to 0 and 1.
  [[nodiscard]] torch::Tensor codes(double scale) const;

  /// [N, views] of 0 and 1: where the parameter is positive.
  [[nodiscard]] torch::Tensor binary_codes() const;

  [[nodiscard]] const torch::Tensor& parameters() const { return parameters_; }

 private:
  [[nodiscard]] torch::Tensor tied(const torch::Tensor& free) const;
  PatternTie tie_;
  torch::Tensor parameters_;  // [number of free patterns, views]
};

/// Coded intensities normalised by the number of views: light_field [batch, views, y, x], codes [N, views] ->
/// [batch, N, y, x].
[[nodiscard]] torch::Tensor coded_intensities(const torch::Tensor& light_field, const torch::Tensor& codes);

/// What is random in the sensor.
struct SensorNoise {
  torch::Tensor w;  ///< of the log intensity: standard normal, float32 [batch, N - 1, y, x]
  torch::Tensor z;  ///< of the threshold: likewise
  /// Thresholds by which each pixel's reference is above the first log intensity, float32 [batch, y, x]; undefined:
  /// none. When darkness falls, a pixel's last event leaves its reference anywhere within one.
  torch::Tensor residue = {};
  torch::Tensor image = {};  ///< of intensity images: standard normal, as large as they are; undefined: there are none
};

/// Draws w and z from torch's generator.
[[nodiscard]] SensorNoise draw_noise(at::IntArrayRef shape, torch::Device device);

/// Draws what is random in the measurements of light fields [batch, 64, height, width] with N patterns.
[[nodiscard]] SensorNoise draw_noise(capture::MeasurementKind measurement, int64_t batch, int64_t num_patterns,
                                     int64_t height, int64_t width, torch::Device device);

/// The intensity images [batch, capture::num_images(), y, x] of a measurement, from light fields [batch, 64, y, x] and
/// their coded intensities; undefined where it has none. Behind a lens array y and x are multiples of 8. Noise is
/// sigma * noise.
[[nodiscard]] torch::Tensor measure_images(capture::MeasurementKind kind, const torch::Tensor& light_field,
                                           const torch::Tensor& intensities, double sigma, const torch::Tensor& noise);

/// Event images [batch, N - 1, y, x] of whole numbers from coded intensities [batch, N, y, x]. Rounding toward zero has
/// the gradient of the identity. Noise is sigma_w * w on the log intensity and sigma_z * z on the threshold, which
/// stays above 0.01.
[[nodiscard]] torch::Tensor simulate_events(const torch::Tensor& intensities, const SampleConstants& constants,
                                            const SensorNoise& noise, EventModel event_model);

[[nodiscard]] torch::Tensor to_tensor(const capture::Codes& codes, torch::Device device);  ///< [N, views]
[[nodiscard]] capture::Codes to_codes(const torch::Tensor& codes, size_t views_y, size_t views_x);

}  // namespace e2lf::learn
