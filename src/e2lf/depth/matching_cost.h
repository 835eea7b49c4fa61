// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::depth {

/// The view whose pixels get a disparity.
struct ViewIndex {
  size_t y = 0, x = 0;
  bool operator==(const ViewIndex&) const = default;
};

/// Equally spaced disparities: first, first + step, ..., px per view step.
struct Labels {
  float first = 0, step = 0.125F;
  size_t count = 1;

  [[nodiscard]] float disparity(float label) const { return first + step * label; }
};

inline constexpr int16_t kMostCost = 1023;

/// How badly each disparity explains each pixel: int16 [y, x, label] in [0, kMostCost].
struct CostVolume {
  size_t height = 0, width = 0;
  Labels labels;
  std::vector<int16_t> costs;

  [[nodiscard]] const int16_t* at(size_t y, size_t x) const { return costs.data() + (y * width + x) * labels.count; }
  [[nodiscard]] int16_t* at(size_t y, size_t x) { return costs.data() + (y * width + x) * labels.count; }
};

/// The cost of disparity d at a pixel (y, x) of the reference view r: views v are read at (y, x) + d (v - r), by cubic
/// interpolation, and compared with the reference; |difference| counts up to `most_difference`. Where something hides
/// the pixel from some views, it does so on one side: the cost is the mean over all views, or over those left, right,
/// above or below the reference where that is clearly less. Averaged over 3x3 px, and scaled so that most_difference is
/// kMostCost. Grey light fields of more than one view.
[[nodiscard]] CostVolume matching_costs(const lightfield::LightField& light_field, const ViewIndex& reference,
                                        const Labels& labels, float most_difference, const ProgressFn& progress = {});

}  // namespace e2lf::depth
