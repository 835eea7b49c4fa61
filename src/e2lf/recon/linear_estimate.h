// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/recon/placed_images.h"

namespace e2lf::recon {

/// The prior for the views of a light field at one (disparity-corrected) point.
struct ViewPrior {
  double correlation_length = 8.0;  ///< in view steps: correlation exp(-distance^2 / (2 length^2))
  double noise = 0.3;  ///< variance of the noise of a normalised coded image relative to the variance of a view; must
                       ///< be positive if two patterns are alike
};

/// Computes the best linear unbiased estimate of each view from the coded images J_n = I_n / (share of open cells), as
/// weights [view][pattern] that sum to 1 over the patterns and are 0 for patterns without light. With K the prior
/// correlation of the views and B the patterns scaled to sum 1, w is the solution of
///   (B K B^T + noise) w + m = B K e_v,  sum(w) = 1
/// (kriging with unknown mean m). At least one pattern must transmit light, or the contract is broken.
[[nodiscard]] std::vector<std::vector<double>> view_weights(const capture::Codes& codes, const ViewPrior& prior);

struct LinearEstimateOptions {
  ViewPrior prior = {};
  DisparitySearch search = {};
  size_t denoise_radius = 3;  ///< see denoise_intensities(); used only by reconstruct_by_inversion()
};

/// Estimates a light field from coded intensities without training. Each coded image, divided by the share of open
/// cells of its pattern, is treated as a picture seen from the centre of light of the pattern. Their disparity is
/// estimated by window matching (coded_disparity()). Each view is then the best linear combination (view_weights()) of
/// the pictures, each shifted by its disparity to the view. Blur over the open cells and occlusions are not removed.
/// The result is not clamped. Fails with kShape (different numbers of images and patterns, or empty images) and
/// kInvalidValue (all patterns are black).
[[nodiscard]] Result<lightfield::LightField> linear_estimate(const capture::CodedIntensities& intensities,
                                                             const capture::Codes& codes,
                                                             const LinearEstimateOptions& options = {});

/// Implements the method "inversion": linear_estimate() of the centred closed-form inversion of the events
/// (invert_events()). Also fails with kInvalidValue if no pattern is black.
[[nodiscard]] Result<lightfield::LightField> reconstruct_by_inversion(const capture::EventImages& images,
                                                                      const capture::Codes& codes,
                                                                      const capture::SensorConstants& constants,
                                                                      const LinearEstimateOptions& options = {});

}  // namespace e2lf::recon
