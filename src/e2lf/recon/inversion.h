// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::recon {

struct InversionOptions {
  size_t black = 0;  ///< the number n_B of the black pattern, counted from 0
  capture::SensorConstants constants = {};
  bool centred = false;  ///< see invert_events()
};

/// Computes the coded intensities of N patterns from N - 1 event images in closed form (Eq. 7), for patterns before and
/// after the black one: I_n = eps (exp(tau C_n) - 1), where C_n is the sum of the events from pattern n_B to pattern n,
/// with the opposite sign if n < n_B. Noise can make values negative. Very large counts are limited so that values stay
/// finite.
///
/// Counting truncates toward zero, so the log intensity of a pixel lies up to one threshold beyond its counted level,
/// on the side of its last change. `centred` adds half a threshold on that side: it uses C_n + (s_n - s_B) / 2 instead
/// of C_n, where s_k is the sign of the last non-zero count up to pattern k, and 0 before the first.
///
/// Fails with kInvalidValue (eps or tau not positive, or no pattern n_B).
[[nodiscard]] Result<capture::CodedIntensities> invert_events(const capture::EventImages& images,
                                                              const InversionOptions& options);

/// Computes the sums of `values` [y, x] over the square window of `radius` around each pixel. Border pixels are
/// repeated.
[[nodiscard]] std::vector<float> box_sums(std::span<const float> values, size_t height, size_t width, size_t radius);

/// Replaces the coded intensity after each transition k (patterns 1..N-1) by a local Wiener estimate of its logarithm
/// over a window of `radius`: mean + max(0, variance - noise) / variance * (value - mean). The noise follows from the
/// event model: sigma_w^2 + tau^2 / 12 (quantisation) + (E_k sigma_z)^2 (the threshold noise, once per event). Flat
/// areas are averaged, and edges that exceed the noise are preserved.
void denoise_intensities(capture::CodedIntensities& intensities, const capture::EventImages& images,
                         const capture::SensorConstants& constants, size_t radius);

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

/// A picture [y, x] seen from a place on the aperture, in view steps relative to the centre of the views.
struct PlacedImage {
  std::vector<float> pixels;
  double view_y = 0, view_x = 0;
};

/// Coded images as pictures seen from the centres of light of their patterns, divided by the share of open cells.
struct PlacedImages {
  std::vector<PlacedImage> images;
  std::vector<size_t> patterns;  ///< the number of the pattern of each; black patterns are omitted
};

[[nodiscard]] PlacedImages place_images(const capture::CodedIntensities& intensities, const capture::Codes& codes);

/// Samples a picture bilinearly at (y, x). The coordinates are clamped to the picture.
[[nodiscard]] float sample_bilinear(std::span<const float> pixels, size_t height, size_t width, float y, float x);

/// Estimates the disparity [y, x] as seen from the centre of the views, within +-3 px per view step: for each pixel,
/// the candidate with the smallest relative difference between the pictures over a window. It is 0 everywhere if all
/// pictures have the same place.
[[nodiscard]] std::vector<float> coded_disparity(std::span<const PlacedImage> images, size_t height, size_t width);

/// Estimates a light field from coded intensities without training. Each coded image, divided by the share of open
/// cells of its pattern, is treated as a picture seen from the centre of light of the pattern. Their disparity is
/// estimated by window matching (coded_disparity()). Each view is then the best linear combination (view_weights()) of
/// the pictures, each shifted by its disparity to the view. Blur over the open cells and occlusions are not removed.
/// The result is not clamped. Fails with kShape (different numbers of images and patterns, or empty images) and
/// kInvalidValue (all patterns are black).
[[nodiscard]] Result<lightfield::LightField> linear_estimate(const capture::CodedIntensities& intensities,
                                                             const capture::Codes& codes);

/// Implements the method "inversion": linear_estimate() of the centred closed-form inversion of the events
/// (invert_events()). Also fails with kInvalidValue if no pattern is black.
[[nodiscard]] Result<lightfield::LightField> reconstruct_by_inversion(const capture::EventImages& images,
                                                                      const capture::Codes& codes,
                                                                      const capture::SensorConstants& constants);

}  // namespace e2lf::recon
