// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/depth/matching_cost.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::depth {

/// What a change of disparity from a pixel to its neighbour costs, in the units of CostVolume.
struct ChangeCosts {
  int16_t one_label = 64;  ///< by one label: a slanted surface
  int16_t most = 640;      ///< by more, where both pixels are equally bright; less at edges of the picture
  int16_t least = 64;      ///< by more, at strong edges
  float edge = 0.03F;      ///< the difference in brightness that halves it
};

/// Replaces the cost of each label by the cost of the best paths to the pixel that end with it, summed over eight
/// directions: semi-global matching (Hirschmueller, "Stereo processing by semiglobal matching and mutual information",
/// PAMI 2008). `picture` is the grey reference view.
void smooth_costs(CostVolume& volume, const lightfield::Image& picture, const ChangeCosts& change);

}  // namespace e2lf::depth
