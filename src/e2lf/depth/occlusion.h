// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>

#include "e2lf/depth/disparity.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::depth {

/// What occlusion says of the sign of disparities: nearer things hide farther ones, and have the smaller disparity
/// where views lie as they should.
struct OcclusionSign {
  enum class Verdict { kUndecided, kUpright, kTurned };

  size_t places = 0;              ///< areas of the picture where something hides something else
  float smaller_in_front = 0.5F;  ///< the share of the evidence that the smaller disparity is in front there, in [0, 1]
  float deviations = 0;           ///< how many standard deviations that is above (below: negative) what chance makes
  Verdict verdict = Verdict::kUndecided;

  /// That the verdict is right, in [0.5, 1]: the share of the evidence that agrees with it.
  [[nodiscard]] float confidence() const { return std::max(smaller_in_front, 1 - smaller_in_front); }
};

/// Looks at pixels of two surfaces that meet in a view far from map.view, and asks whose texture is seen there; pixels
/// count that agree with the opposite view, in which the surfaces part. Both signs are treated alike. `map` is of this
/// light field. Without views on both sides of map.view nothing is found.
[[nodiscard]] OcclusionSign occlusion_sign(const lightfield::LightField& light_field, const DisparityMap& map);

}  // namespace e2lf::depth
