// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::sensor {

using capture::CodedIntensities;

/// Computes the coded intensities of a grey light field, I_n = sum(a_n * L) / views (Eq. 1). Views are summed in the
/// order of their numbers, so that the result is the same for any number of threads and any instruction set. Fails with
/// kShape if the views of codes and light field differ or if the light field has colour.
[[nodiscard]] Result<CodedIntensities> coded_intensities(const capture::Codes& codes,
                                                         const LightFieldView& light_field);

/// Checks that `codes` can be applied to `light_field`, as coded_intensities() does.
[[nodiscard]] Result<void> check_fit(const capture::Codes& codes, const LightFieldView& light_field);

struct ImageOptions {
  float sigma = 0.005F;  ///< standard deviation of the noise of each pixel in each image
  float gain = 1.0F;     ///< scene brightness, which multiplies every intensity
  uint64_t seed = 1;     ///< seed of the noise
};

/// Returns the intensity images that a measurement of this kind contains for a grey light field: gain * I_n (Eq. 1) for
/// each pattern, or their sum, or the image behind a lens array, plus Gaussian noise. There is no image if the kind has
/// none. Lenses at the right and lower edge may cover less than 8 pixels of the light field; they average over those
/// pixels, and the image has the size of whole lenses. Values are not clamped. The result does not depend on the number
/// of threads. Fails as coded_intensities() does, with kShape if a lens array is used with other than 8x8 views, and
/// with kInvalidValue for a gain or noise that is negative or not finite.
[[nodiscard]] Result<capture::CodedIntensities> measure_images(capture::MeasurementKind kind,
                                                               const capture::Codes& codes,
                                                               const LightFieldView& light_field,
                                                               const ImageOptions& options);

}  // namespace e2lf::sensor
