// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/depth/true_disparity.h"
#include "e2lf/lightfield/light_field.h"

/// What other verbs show in the viewer. In a build without it, these functions fail with kMissingDependency.
namespace e2lf::cli {

/// Returns true if this build includes `e2lf view`.
[[nodiscard]] bool has_viewer();
/// Fails without it, so that verbs say so before they open anything.
[[nodiscard]] Result<void> require_viewer();

/// A light field, with the disparities of its middle view.
struct Shown {
  const lightfield::LightField& light_field;
  const lightfield::Image& disparity;
};

/// Writes a self-contained HTML file in which the viewer shows a scene beside its reconstruction, whose disparities
/// have this error. Fails with kIo, and with kUnsupported (a browser would not have enough memory for the views).
[[nodiscard]] Result<void> write_comparison_page(const std::filesystem::path& path, const Shown& truth,
                                                 const Shown& reconstruction,
                                                 const std::optional<depth::DisparityError>& error);

}  // namespace e2lf::cli
