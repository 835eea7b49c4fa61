// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/colour_filter.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::sensor {

using capture::CodedIntensities;

/// Computes the coded intensities of a grey light field, I_n = sum(a_n * L) / views (Eq. 1). Views are summed in the
/// order of their numbers, so that the result is the same for any number of threads and any instruction set. Fails with
/// kShape if the views of codes and light field differ or if the light field has colour.
[[nodiscard]] Result<CodedIntensities> coded_intensities(const capture::Codes& codes,
                                                         const lightfield::LightField& light_field);

/// Checks that `codes` can be applied to `light_field`, as coded_intensities() does.
[[nodiscard]] Result<void> check_fit(const capture::Codes& codes, const lightfield::LightField& light_field);

/// Returns the light on the pixels of a sensor with colour filters: a grey light field of twice the height and width,
/// in which each pixel of a 2x2 block takes the channel of its filter. All four see the same point; the parallax within
/// a block is neglected. A grey light field breaks the contract.
[[nodiscard]] lightfield::LightField light_behind(const capture::ColourFilter& filter,
                                                  const lightfield::LightField& colour);

}  // namespace e2lf::sensor
