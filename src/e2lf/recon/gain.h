// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/lightfield/light_field.h"

namespace e2lf::recon {

/// Returns the factor that makes a light field well exposed: it maps a robust bright level (the 99.5 % quantile of
/// all views; large light fields are sampled at regular intervals) to 0.9. Real scenes can be far darker relative to
/// the sensor's dark level than the training data of the model. The gain is 1 if the level is already bright (0.7..1)
/// or if there is no light. It is always in [0.25, 64]. Brightness is measured above `black`, which the caller
/// subtracts afterwards.
[[nodiscard]] float auto_gain(const lightfield::LightField& light_field, float black = 0.0F);

/// Returns the brightness that should become black: the 0.5 % quantile over the views, limited to between 0 and 0.15 of
/// the bright level. It is meant for cameras whose events determine brightness only up to a constant: if the
/// photoreceptor lags, a dark level of the scene cannot be distinguished from a slower receptor
/// (docs/experiments/camera-fit.md).
[[nodiscard]] float auto_black(const lightfield::LightField& light_field);

/// Subtracts `black` and multiplies by `gain`, in place.
void apply_tone(lightfield::LightField& light_field, float black, float gain);

}  // namespace e2lf::recon
