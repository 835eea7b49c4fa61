// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>

#include "e2lf/base/result.h"
#include "e2lf/depth/disparity.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::depth {

/// The sign of the disparities that occlusions imply: nearer objects hide farther ones, and have the smaller disparity
/// if the views are in the right order.
struct OcclusionSign {
  enum class Verdict { kUndecided, kUpright, kTurned };

  size_t places = 0;              ///< number of areas of the picture with an occlusion
  float smaller_in_front = 0.5F;  ///< share of the evidence for the smaller disparity being in front, in [0, 1]
  float deviations = 0;           ///< deviation from chance in standard deviations; negative if below
  Verdict verdict = Verdict::kUndecided;

  /// Returns the confidence in the verdict, in [0.5, 1]: the share of the evidence that agrees with it.
  [[nodiscard]] float confidence() const { return std::max(smaller_in_front, 1 - smaller_in_front); }
};

/// Determines the sign from pixels of two surfaces that coincide in a view far from map.view: the one whose texture is
/// seen there is in front. Pixels count only if they agree with the opposite view, in which the surfaces separate. Both
/// signs are treated alike. `map` must belong to this light field. Without views on both sides of map.view, nothing is
/// found.
[[nodiscard]] OcclusionSign occlusion_sign(const lightfield::LightField& light_field, const DisparityMap& map);

/// Returns the mean confidence of a map, in [0, 1].
[[nodiscard]] double mean_confidence(const DisparityMap& map);

}  // namespace e2lf::depth
