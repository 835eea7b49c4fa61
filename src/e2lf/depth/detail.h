// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/lightfield/light_field.h"

namespace e2lf::depth {

/// Returns a grey light field without most of its shading: from each pixel it subtracts 70 % of the mean of similar
/// pixels around it in the same view, a separable bilateral mean within 4 px. Shading and reflections that do not move
/// with the surface would otherwise outweigh weak texture, and the mean over dissimilar pixels would extend edges.
[[nodiscard]] lightfield::LightField detail_of(const lightfield::LightField& light_field);

}  // namespace e2lf::depth
