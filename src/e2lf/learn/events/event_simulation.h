// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>
#include <vector>

#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/learn/network/network_module.h"
#include "e2lf/model/model.h"

namespace e2lf::learn {
using capture::EventModel;

/// Constants of the physical pixels of each sample, on the device of the light fields unless stated otherwise.
struct PixelSamples {
  torch::Tensor is_pixel;      ///< bool [batch] on the CPU; false for samples of the paper's models
  torch::Tensor constants;     ///< float32 [batch, capture::kNumPixelConstants]
  torch::Tensor transmission;  ///< float32 [batch, number of codes]; that of black is 1
  int64_t cycles = 1;          ///< number of cycles over which the counts are averaged

  /// Returns one constant, float32 [batch, 1, 1].
  [[nodiscard]] torch::Tensor at(capture::PixelConstant constant) const {
    return constants.select(1, static_cast<int64_t>(constant)).reshape({-1, 1, 1});
  }
};

/// Sensor constants of each sample: float32 [batch, 1, 1] each, on the device of the light fields.
struct SampleConstants {
  torch::Tensor eps, tau, sigma_w, sigma_z;
  PixelSamples pixel = {};          ///< constants of samples with physical pixels; undefined tensors if there are none
  torch::Tensor conditioning = {};  ///< the conditioning vectors, float32 [batch, capture::conditioning_size(N)]
};

/// Returns the same constants for every sample, without conditioning vectors.
[[nodiscard]] SampleConstants repeat_constants(const capture::SensorConstants& constants, int64_t batch,
                                               torch::Device device);

/// Returns one sample of a camera at its stated values, with its conditioning vector, for counts that are averaged over
/// `cycles`. The number of patterns is `num_codes`, or 2 * num_codes + 1 for a whole cycle.
[[nodiscard]] SampleConstants sample_of(const capture::SensorProfile& camera, size_t num_patterns, size_t num_codes,
                                        size_t cycles, torch::Device device);

/// Constraints between the patterns.
enum class PatternTie {
  kNone,
  kBlackFirst,     ///< the first pattern is black and has no parameters
  kComplementary,  ///< every second pattern is the inverse of the one before, so that all cells are open equally long
  kWholeCycle,     ///< the patterns are capture::whole_cycle() of codes whose first is black
};

/// Trainable aperture patterns, sigmoid(scale * parameters).
class Patterns {
 public:
  /// Initialises each pattern as a soft disc at a random position, drawn from torch's generator. (With white noise of
  /// small amplitude, all patterns would initially measure the same, and training would begin by closing every cell.)
  /// At least one pattern must have parameters, and the number of complementary patterns must be even.
  Patterns(size_t num_patterns, PatternTie tie, torch::Device device);

  /// Initialises the patterns from binary codes [n, views] instead, all cells equally soft. Patterns beyond the n-th
  /// keep their initial values.
  void start_at(const torch::Tensor& codes);

  /// Initialises the patterns with white noise of standard deviation `width` instead.
  void start_at_noise(double width);

  /// Returns the patterns [N, views] in [0, 1], differentiable. Increasing the scale drives them to 0 and 1.
  [[nodiscard]] torch::Tensor codes(double scale) const;

  /// Returns the binary patterns [N, views]: 1 where the parameter is positive, 0 elsewhere.
  [[nodiscard]] torch::Tensor binary_codes() const;

  [[nodiscard]] const torch::Tensor& parameters() const { return parameters_; }

 private:
  [[nodiscard]] torch::Tensor tied(const torch::Tensor& free) const;
  PatternTie tie_;
  torch::Tensor parameters_;  // [number of free patterns, views]
};

/// Computes the coded intensities [batch, N, y, x], normalised by the number of views, from light fields [batch, views,
/// y, x] and codes [N, views].
[[nodiscard]] torch::Tensor coded_intensities(const torch::Tensor& light_field, const torch::Tensor& codes);

/// The samples of a batch whose scenes move while the patterns are shown.
struct MovingSamples {
  torch::Tensor places = {};        ///< in the batch, int64 [m]; undefined if all scenes stand still
  torch::Tensor light_fields = {};  ///< scenes at the time of each pattern, uint8 [m, N, views, y, x]
  torch::Tensor scale = {};         ///< the light of a grey level, float32 [m]
};

/// The light that reaches the pixels through each pattern.
struct CodedLight {
  torch::Tensor intensities;  ///< [batch, N, y, x], as coded_intensities() computes them
  torch::Tensor full;  ///< intensities with all cells open, [batch, y, x], or [batch, N, y, x] if any scene moves
};

/// Computes the light of scenes that are `light_field` [batch, views, y, x] at the time of the last pattern.
[[nodiscard]] CodedLight coded_light(const torch::Tensor& light_field, const torch::Tensor& codes,
                                     const MovingSamples& moving);

/// The random quantities of the sensor.
struct SensorNoise {
  torch::Tensor w = {};  ///< noise of the log intensity: standard normal, float32 [batch, N - 1, y, x]
  torch::Tensor z = {};  ///< noise of the threshold: standard normal, of the same shape
  /// The distance of each pixel's initial reference above the first log intensity, in thresholds, float32 [batch, y,
  /// x]; none if undefined. After the change to black, the last event of a pixel leaves its reference anywhere between
  /// 0 and 1.
  torch::Tensor residue = {};
  torch::Tensor image = {};  ///< noise of intensity images: standard normal; undefined if there are none
};

/// Draws the random quantities of a measurement of light fields [batch, 64, height, width] with N patterns from torch's
/// generator, except the residue.
[[nodiscard]] SensorNoise draw_noise(capture::MeasurementKind measurement, int64_t batch, int64_t num_patterns,
                                     int64_t height, int64_t width, torch::Device device);

/// Computes the intensity images [batch, capture::num_images(), y, x] of a measurement from light fields [batch, 64, y,
/// x] and their coded intensities. Adds sigma * noise. The result is undefined if the measurement has no images. For a
/// lens array, y and x must be multiples of 8.
[[nodiscard]] torch::Tensor measure_images(capture::MeasurementKind kind, const torch::Tensor& light_field,
                                           const torch::Tensor& intensities, double sigma, const torch::Tensor& noise);

/// Simulates event images [batch, N - 1, y, x] with integral values from coded intensities [batch, N, y, x]. The noise
/// is sigma_w * w on the log intensity and sigma_z * z on the threshold, which is at least 0.01. Rounding toward zero
/// has the gradient of the identity.
[[nodiscard]] torch::Tensor simulate_events(const torch::Tensor& intensities, const SampleConstants& constants,
                                            const SensorNoise& noise, EventModel event_model);

/// Computes the event images [batch, P - 1, y, x], averaged over the cycles, of pixels that follow the light with a
/// lag. The camera's cycle has a closed-form solution: the inverse of the last code, black, codes 2 to N, and for a
/// whole cycle their inverses and black again. `intensities` [batch, P, y, x] are the coded intensities of the N codes
/// (P = N) or of capture::whole_cycle() of them (P = 2N + 1); the first is black. `full` is the intensity with all
/// cells open, [batch, y, x], or [batch, P, y, x] if it changes from pattern to pattern. An inverse transmits the light
/// of the open aperture that its code blocks. The change to black causes the OFF events that bring the reference down
/// to the level.
///
/// The log intensity u of the photoreceptor obeys du/dt = K (J - exp u) with J = (I + eps) / eps. This is linear in w =
/// exp(-u), so that w relaxes to 1 / J at the rate K J. The level of the amplifier relaxes to u at its own rate. At the
/// end of a pattern, the level with its noise is compared with the reference: count = trunc((level - reference) /
/// threshold), and the reference moves by threshold * count. After black, the reference lies up to reset_span OFF
/// thresholds above the level. The function draws from torch's generator: thresholds once per pixel, everything else
/// once per cycle. Rounding has the gradient of the identity.
[[nodiscard]] torch::Tensor simulate_pixel_events(const torch::Tensor& intensities, const torch::Tensor& full,
                                                  const PixelSamples& samples);

[[nodiscard]] torch::Tensor to_tensor(const capture::Codes& codes, torch::Device device);  ///< [N, views]
[[nodiscard]] capture::Codes to_codes(const torch::Tensor& codes, size_t views_y, size_t views_x);

/// Computes the input channels of the network, [batch, model::num_input_channels(), y, x], from event images [batch, N
/// - 1, y, x] and intensity images [batch, images, y, x], if there are any, as model::InputGroup defines them.
/// Differentiable. Uses eps, tau and the conditioning vector of each sample.
[[nodiscard]] torch::Tensor form_inputs(const torch::Tensor& events, const std::vector<model::InputGroup>& groups,
                                        const SampleConstants& constants, const torch::Tensor& images = {});

/// Returns the origins of the input channels of a network for N patterns in a model with other groups or fewer
/// patterns. The origin of a channel is the same transition, or the same number of the conditioning vector, in the
/// group of the same kind. The factors compensate for different scales of the groups.
[[nodiscard]] std::vector<InputOrigin> input_origins(const model::Model& start,
                                                     const std::vector<model::InputGroup>& groups, size_t num_patterns);

}  // namespace e2lf::learn
