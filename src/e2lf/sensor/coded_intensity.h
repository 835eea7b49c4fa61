// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/coded_intensities.h"
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

}  // namespace e2lf::sensor
