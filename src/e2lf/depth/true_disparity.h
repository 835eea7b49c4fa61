// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/depth/disparity.h"
#include "e2lf/depth/disparity_error.h"

namespace e2lf::depth {

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

/// Returns the disparities in `file`, or those of estimate_disparity() on the true views if there is no file. Fails
/// with kShape (the map has another size than the views), and as read_disparity() and estimate_disparity() do.
[[nodiscard]] Result<TrueDisparity> true_disparity(const lightfield::LightField& true_views,
                                                   const std::optional<std::filesystem::path>& file);

/// Returns true if light fields of this shape have a disparity that compare() accepts: several views that are more than
/// two borders high and wide.
[[nodiscard]] bool has_comparable_disparity(const lightfield::Shape& shape);

}  // namespace e2lf::depth
