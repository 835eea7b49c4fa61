// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>

#include "e2lf/base/result.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/depth/disparity_error.h"
#include "e2lf/lightfield/light_field.h"

/// What other verbs show in the viewer. In a build without it, these functions fail with kMissingDependency.
namespace e2lf::cli {

/// Whether this build includes `e2lf view`.
#ifdef E2LF_NO_VIEWER
inline constexpr bool kHasViewer = false;
#else
inline constexpr bool kHasViewer = true;
#endif
/// Returns the error of what needs it, so that verbs fail before they open anything.
[[nodiscard]] Error no_viewer_error();

/// A light field, with the disparities of its middle view.
struct ComparedLightField {
  const lightfield::LightField& light_field;  ///< limited to [0, 1] for the figures, as its files are
  const lightfield::Image& disparity;
};

/// Writes a self-contained HTML file in which the viewer shows a scene beside its reconstruction, whose disparities
/// have this error. Fails with kIo, and with kUnsupported (a browser would not have enough memory for the views).
[[nodiscard]] Result<void> write_comparison_page(const std::filesystem::path& path, const ComparedLightField& truth,
                                                 const ComparedLightField& reconstruction,
                                                 const std::optional<depth::DisparityError>& error);

}  // namespace e2lf::cli
