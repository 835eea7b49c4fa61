// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/recon/placed_images.h"

namespace e2lf::recon {

struct RegularisedOptions {
  float smoothness = 3.0F;  ///< weight of the total variation; an error of one standard deviation costs 1/2
  size_t iterations = 60;
  DisparitySearch search = {};
  size_t denoise_radius = 3;  ///< radius for the images used to estimate the disparity; see denoise_intensities()
};

/// Implements the method "regularised", a classical optimisation without training. Its prior is that all views show one
/// picture, shifted by a disparity (i.e. they have rank one once that is undone), whose total variation is small. With
/// the disparity of coded_disparity(), the views of a picture C are linear in C, and so are the coded intensities I_n.
/// C is the minimum, in [0, 1.5], of
///   sum over patterns n and pixels of 1/2 (distance of I_n from its interval / s_n)^2 + smoothness * TV(C).
/// The interval of I_n follows from the counts of all transitions together (Eq. 6) and extends half a threshold to
/// either side of the centred inversion; s_n is the standard deviation of the sensor noise there. Blur over the open
/// cells is removed, but occlusion is not. The primal-dual iteration of Condat and Vu (2013) is run a fixed number of
/// times. The result does not depend on the number of threads. Fails as reconstruct_by_inversion() does.
[[nodiscard]] Result<lightfield::LightField> reconstruct_regularised(const capture::EventImages& images,
                                                                     const capture::Codes& codes,
                                                                     const capture::SensorConstants& constants,
                                                                     const RegularisedOptions& options = {},
                                                                     const ProgressFn& progress = {});

}  // namespace e2lf::recon
