// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/lightfield/light_field.h"

namespace e2lf::recon {

/// The factor that brings a light field to a well-exposed picture: a robust bright level (the 99.5 % quantile over the
/// views, of a regular sample when there are many values) maps to 0.9. Real scenes can be far darker relative to the
/// sensor's dark level than the model's training data; a light field that is bright already (0.7..1) keeps the gain 1,
/// and so does one without any light. Always in [0.25, 64].
[[nodiscard]] float auto_gain(const lightfield::LightField& light_field);

}  // namespace e2lf::recon
