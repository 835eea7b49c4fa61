// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/depth/matching_cost.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::depth {

/// The costs of disparity changes between neighbouring pixels, in the units of CostVolume.
struct ChangeCosts {
  int16_t one_label = 64;  ///< change by one disparity hypothesis, as on slanted surfaces
  int16_t most = 640;      ///< larger change between equally bright pixels; lower where the brightness changes
  int16_t least = 64;      ///< larger change at strong edges
  float edge = 0.03F;      ///< the difference in brightness that halves `most`
};

/// Replaces the cost of each disparity hypothesis by the cost of the best paths to the pixel that end with it, summed
/// over eight directions: semi-global matching (Hirschmueller, "Stereo processing by semiglobal matching and mutual
/// information", PAMI 2008). `picture` is the grey reference view.
void smooth_costs(CostVolume& volume, const lightfield::Image& picture, const ChangeCosts& change);

}  // namespace e2lf::depth
