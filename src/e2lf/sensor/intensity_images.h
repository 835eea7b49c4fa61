// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::sensor {

struct ImageOptions {
  float sigma = 0.005F;  ///< of the noise of each pixel of each image
  float gain = 1.0F;     ///< scene brightness: multiplies every intensity
  uint64_t seed = 0;     ///< of the noise
};

/// The intensity images that a measurement of this kind has of a grey light field: gain * I_n (Eq. 1) of each pattern,
/// or the sum of them, or what a lens array gives, plus Gaussian noise. No image where the kind has none. Lenses at the
/// right and lower edge may cover less than 8 pixels of the light field: they are means over those, and the image is
/// as large as whole lenses. Values are not clamped. The same for any thread count. Fails as coded_intensities() does,
/// with kShape where a lens array meets other than 8x8 views, and with kInvalidValue for a gain or noise that is
/// negative or not finite.
[[nodiscard]] Result<capture::CodedIntensities> measure_images(capture::MeasurementKind kind,
                                                               const capture::Codes& codes,
                                                               const lightfield::LightField& light_field,
                                                               const ImageOptions& options);

}  // namespace e2lf::sensor
