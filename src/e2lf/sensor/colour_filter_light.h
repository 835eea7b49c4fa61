// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/capture/measurement/colour_filter.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::sensor {

/// Returns the light on the pixels of a sensor with colour filters: a grey light field of twice the height and width,
/// in which each pixel of a 2x2 block takes the channel of its filter. All four see the same point; the parallax within
/// a block is neglected. A grey light field breaks the contract.
[[nodiscard]] lightfield::LightField light_behind(const capture::ColourFilter& filter,
                                                  const lightfield::LightField& colour);

}  // namespace e2lf::sensor
