// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/coded_intensities.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::sensor {

using capture::CodedIntensities;

/// The coded intensities of a grey light field, I_n = sum(a_n * L) / views (Eq. 1). Views are summed in the order of
/// their numbers, so the result is the same for any thread count and instruction set. Fails with kShape when the views
/// of codes and light field differ or the light field has colour.
[[nodiscard]] Result<CodedIntensities> coded_intensities(const capture::Codes& codes,
                                                         const lightfield::LightField& light_field);

/// Success when `codes` can be applied to `light_field`: the checks of coded_intensities().
[[nodiscard]] Result<void> check_fit(const capture::Codes& codes, const lightfield::LightField& light_field);

}  // namespace e2lf::sensor
