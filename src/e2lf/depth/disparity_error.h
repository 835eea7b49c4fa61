// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/depth/disparity.h"
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

/// The disparities of middle_view() against which light fields of a scene are judged.
struct TrueDisparity {
  lightfield::Image disparity;  ///< px per view step, [y, x]
  std::string source;           ///< the file, or kDepthOfTrueViews
};

inline constexpr const char* kDepthOfTrueViews = "depth of the true views";

/// The disparities that estimate_disparity() finds in a light field, and their error.
struct FoundDisparity {
  lightfield::Image disparity;  ///< of middle_view(), px per view step, [y, x]
  DisparityError error;
};

/// Judges a light field by its disparities. Fails as estimate_disparity() and compare() do.
[[nodiscard]] Result<FoundDisparity> judge_disparity(const lightfield::LightField& light_field,
                                                     const lightfield::Image& truth, const ProgressFn& progress = {});

/// Reads a disparity map: .npy, [y, x], or .pfm with the sign of the benchmark. Fails with kUnsupported (another
/// extension), kShape (not two axes) and as reading the file does.
[[nodiscard]] Result<lightfield::Image> read_disparity(const std::filesystem::path& path);

/// Returns the file of true disparities in the folder of a scene: gt_disparity.npy, or gt_disp_lowres.pfm as in the HCI
/// benchmark. Returns nothing if there is none.
[[nodiscard]] std::optional<std::filesystem::path> find_true_disparity(const std::filesystem::path& scene);

/// Reads the true disparities from `file`, or estimates them from the true views if no file is given. Fails with kShape
/// (the map has another size than the views), and as read_disparity() and estimate_disparity() do.
[[nodiscard]] Result<TrueDisparity> true_disparity(const lightfield::LightField& true_views,
                                                   const std::optional<std::filesystem::path>& file);

/// Compares true disparities that come from a file with those that estimate_disparity() finds in the true views. Fails
/// with kInvalidValue if they have the opposite sign. Warns if most are off for another reason, e.g. since they are
/// distances in metres. Fails as judge_disparity() does.
[[nodiscard]] Result<void> check_true_disparity(const lightfield::LightField& true_views, const TrueDisparity& truth,
                                                const ProgressFn& progress = {});

/// Returns true if light fields of this shape have a disparity that compare() accepts: several views that are more than
/// two borders high and wide.
[[nodiscard]] bool has_comparable_disparity(const lightfield::Shape& shape);

}  // namespace e2lf::depth
