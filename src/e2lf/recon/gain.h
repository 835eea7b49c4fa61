// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/lightfield/light_field.h"

namespace e2lf::recon {

/// The factor that brings a light field to a well-exposed picture: a robust bright level (the 99.5 % quantile over the
/// views, of a regular sample when there are many values) maps to 0.9. Real scenes can be far darker relative to the
/// sensor's dark level than the model's training data; a light field that is bright already (0.7..1) keeps the gain 1,
/// and so does one without any light. Always in [0.25, 64].
[[nodiscard]] float auto_gain(const lightfield::LightField& light_field);

/// The brightness that is to become black: the 0.5 % quantile over the views, at least 0 and at most 0.15 of the bright
/// level. For cameras whose events tell brightness up to a constant only: where a photoreceptor lags, a dark level of
/// the scene and a slower receptor look alike (docs/experiments/camera-fit.md).
[[nodiscard]] float auto_black(const lightfield::LightField& light_field);

/// Makes `black` 0 and multiplies by `gain`, in place.
void apply_tone(lightfield::LightField& light_field, float black, float gain);

}  // namespace e2lf::recon
