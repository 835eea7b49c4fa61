// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/depth/matching_cost.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::depth {

/// Replaces the cost of each disparity hypothesis by the cost of the best paths to the pixel that end with it, summed
/// over eight directions: semi-global matching (Hirschmueller, "Stereo processing by semiglobal matching and mutual
/// information", PAMI 2008). `picture` is the grey reference view.
void smooth_costs(CostVolume& volume, const lightfield::Image& picture);

}  // namespace e2lf::depth
