// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/event_images.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_constants.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/recon/coded_disparity.h"

namespace e2lf::recon {

struct RegularisedOptions {
  float smoothness = 3.0F;  ///< weight of the total variation, in units where an error of one noise counts 1/2
  size_t iterations = 60;
  DisparitySearch search = {};
  size_t denoise_radius = 3;  ///< of the images that the disparity is searched in; see denoise_intensities()
};

/// The method "regularised": a classical solution, without training. Its prior is that all views show one picture,
/// moved by a disparity (rank one once that is undone), whose total variation is small. With the disparity of
/// coded_disparity(), the views of a picture C are linear in C, and so are the coded intensities I_n. C is the minimum,
/// in [0, 1.5], of
///   sum over patterns n and pixels of 1/2 (distance of I_n from its interval / s_n)^2 + smoothness * TV(C).
/// The interval is what the counts say of I_n when all transitions are taken together (Eq. 6), half a threshold to
/// either side of the centred inversion; s_n is the deviation of the sensor's noise there. Blur over the open cells is
/// undone, occlusion is not. Condat's and Vu's primal-dual iteration (2013), a fixed number of times; the result is the
/// same for any number of threads. Fails as reconstruct_by_inversion() does.
[[nodiscard]] Result<lightfield::LightField> reconstruct_regularised(const capture::EventImages& images,
                                                                     const capture::Codes& codes,
                                                                     const capture::SensorConstants& constants,
                                                                     const RegularisedOptions& options = {},
                                                                     const ProgressFn& progress = {});

}  // namespace e2lf::recon
