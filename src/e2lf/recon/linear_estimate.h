// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/coded_intensities.h"
#include "e2lf/capture/measurement/event_images.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_constants.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/recon/coded_disparity.h"
#include "e2lf/recon/view_weights.h"

namespace e2lf::recon {

struct LinearEstimateOptions {
  ViewPrior prior = {};
  DisparitySearch search = {};
  size_t denoise_radius = 3;  ///< see denoise_intensities(); used by reconstruct_by_inversion() only
};

/// A light field from coded intensities without any training. Each coded image, divided by its pattern's share of open
/// cells, is taken for a picture from the pattern's centre of light. Their disparity is searched block by block
/// (coded_disparity()); then each view is the best linear combination (view_weights()) of the pictures, each moved by
/// its disparity to the view. Blur over the open cells and occlusions are not undone. The result is not clamped.
/// Fails with kShape (images and patterns differ in number, empty images) and kInvalidValue (every pattern is black).
[[nodiscard]] Result<lightfield::LightField> linear_estimate(const capture::CodedIntensities& intensities,
                                                             const capture::Codes& codes,
                                                             const LinearEstimateOptions& options = {});

/// The method "inversion": linear_estimate() of the centred closed-form inversion of the events (invert_events()).
/// Also fails with kInvalidValue when no pattern is black.
[[nodiscard]] Result<lightfield::LightField> reconstruct_by_inversion(const capture::EventImages& images,
                                                                      const capture::Codes& codes,
                                                                      const capture::SensorConstants& constants,
                                                                      const LinearEstimateOptions& options = {});

}  // namespace e2lf::recon
