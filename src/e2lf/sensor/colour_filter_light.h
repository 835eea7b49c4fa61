// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/capture/measurement/colour_filter.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::sensor {

/// The light field in colour as the pixels of a sensor with colour filters see it: grey, twice as high and as wide,
/// each pixel of a block of 2x2 with the channel of its filter. All four look at the same point: the parallax inside of
/// a block is left out. A grey light field breaks the contract.
[[nodiscard]] lightfield::LightField light_behind(const capture::ColourFilter& filter,
                                                  const lightfield::LightField& colour);

}  // namespace e2lf::sensor
