// SPDX-License-Identifier: MIT
#pragma once

#include <torch/types.h>

#include "e2lf/aperture/codes.h"
#include "e2lf/aperture/sensor_constants.h"

namespace e2lf::learn {

enum class EventModel {
  kQuantised,       ///< Eq. 8: every transition starts from the previous coded intensity
  kReferenceAware,  ///< Eq. 9-10: from the sensor's own reference, zero intensity before the first pattern
};

/// Sensor constants per sample: float32 [batch, 1, 1] each, on the device of the light fields.
struct SampleConstants {
  torch::Tensor eps, tau, sigma_w, sigma_z;
};

/// The same constants for every sample.
[[nodiscard]] SampleConstants repeat_constants(const aperture::SensorConstants& constants, int64_t batch,
                                               torch::Device device);

/// Trainable aperture patterns sigmoid(scale * parameters). With `black_first` the first pattern is zero and has no
/// parameters.
class Patterns {
 public:
  /// Starts each pattern as a soft disc at a random place, from torch's generator. (From small white noise, all
  /// patterns see the same at first, and learning starts by closing every cell.)
  Patterns(size_t num_patterns, bool black_first, torch::Device device);

  /// [N, views] in [0, 1], differentiable. A growing scale drives the patterns to 0 and 1.
  [[nodiscard]] torch::Tensor codes(double scale) const;

  /// [N, views] of 0 and 1: where the parameter is positive.
  [[nodiscard]] torch::Tensor binary_codes() const;

  [[nodiscard]] const torch::Tensor& parameters() const { return parameters_; }

 private:
  [[nodiscard]] torch::Tensor with_black(const torch::Tensor& open) const;
  bool black_first_;
  torch::Tensor parameters_;  // [N or N - 1, views]
};

/// Coded intensities normalised by the number of views: light_field [batch, views, y, x], codes [N, views] ->
/// [batch, N, y, x].
[[nodiscard]] torch::Tensor coded_intensities(const torch::Tensor& light_field, const torch::Tensor& codes);

/// Event images [batch, N - 1, y, x] of whole numbers from coded intensities [batch, N, y, x]. Rounding toward zero has
/// the gradient of the identity. Noise (sigma_w on the log intensity; sigma_z on the threshold, which stays above 0.01)
/// is drawn anew for each pixel and transition from torch's generator.
[[nodiscard]] torch::Tensor simulate_events(const torch::Tensor& intensities, const SampleConstants& constants,
                                            EventModel event_model);

[[nodiscard]] torch::Tensor to_tensor(const aperture::Codes& codes, torch::Device device);  ///< [N, views]
[[nodiscard]] aperture::Codes to_codes(const torch::Tensor& codes, size_t views_y, size_t views_x);

}  // namespace e2lf::learn
