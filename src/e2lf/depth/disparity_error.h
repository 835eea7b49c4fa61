// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::depth {

/// The border that the HCI 4D Light Field Benchmark leaves out.
inline constexpr size_t kErrorBorderPx = 15;

/// The error of a part of the pixels.
struct ErrorPart {
  double pixels_percent = 0;  ///< share of the pixels
  double bad_20_percent = 0;
  double mean_absolute_px = 0;
};

/// The error of a disparity map. *Bad* pixels are off by more than a limit.
struct DisparityError {
  double bad_07_percent = 0;    ///< off by more than 0.07 px per view step
  double bad_20_percent = 0;    ///< off by more than 0.2 px per view step
  double mean_absolute_px = 0;  ///< mean absolute error, px per view step
  double slope = 0;  ///< of the linear regression of the estimate on the truth; 0 if the truth is the same everywhere
  size_t num_pixels = 0;                ///< the number of pixels compared
  std::vector<ErrorPart> most_certain;  ///< the 10 %, 20 %, ..., 100 % of the pixels with the highest confidence; empty
                                        ///< without confidences
};

/// Compares a disparity map of any source with the true one, [y, x] in px per view step, without `border` px on each
/// side and without pixels whose truth is not finite. `confidence` of any scale orders the pixels for `most_certain`;
/// it may be empty. Estimates that are not finite are bad and do not count in the mean and in the slope. Fails with
/// kShape (different sizes, or no pixel within the border) and kInvalidValue (no finite truth or estimate).
[[nodiscard]] Result<DisparityError> compare(const lightfield::Image& estimate, const lightfield::Image& confidence,
                                             const lightfield::Image& truth, size_t border = kErrorBorderPx);

}  // namespace e2lf::depth
