// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::depth {

/// The index of the view whose pixels get a disparity.
struct ViewIndex {
  size_t y = 0, x = 0;
  bool operator==(const ViewIndex&) const = default;
};

/// Equally spaced disparities first, first + step, ..., in px per view step.
struct Labels {
  float first = 0, step = 0.125F;
  size_t count = 1;

  [[nodiscard]] float disparity(float label) const { return first + step * label; }
};

inline constexpr int16_t kMostCost = 1023;

/// The cost of each disparity at each pixel: int16 [y, x, label] in [0, kMostCost].
struct CostVolume {
  size_t height = 0, width = 0;
  Labels labels;
  std::vector<int16_t> costs;

  [[nodiscard]] const int16_t* at(size_t y, size_t x) const { return costs.data() + (y * width + x) * labels.count; }
  [[nodiscard]] int16_t* at(size_t y, size_t x) { return costs.data() + (y * width + x) * labels.count; }
};

/// Computes the cost of disparity d at a pixel (y, x) of the reference view r: each view v is sampled at (y, x) + d (v
/// - r) by cubic interpolation and compared with the reference, where |difference| is limited to `most_difference`. If
/// an object hides the pixel from some views, it does so on one side. The cost is therefore the mean over all views, or
/// over those to the left, to the right, above or below the reference if that is clearly lower. It is averaged over 3x3
/// px and scaled such that most_difference becomes kMostCost. The light field must be grey with more than one view.
[[nodiscard]] CostVolume matching_costs(const lightfield::LightField& light_field, const ViewIndex& reference,
                                        const Labels& labels, float most_difference, const ProgressFn& progress = {});

/// Replaces the cost of each disparity hypothesis by the cost of the best paths to the pixel that end with it, summed
/// over eight directions: semi-global matching (Hirschmueller, "Stereo processing by semiglobal matching and mutual
/// information", PAMI 2008). `picture` is the grey reference view.
void smooth_costs(CostVolume& volume, const lightfield::Image& picture);

}  // namespace e2lf::depth
