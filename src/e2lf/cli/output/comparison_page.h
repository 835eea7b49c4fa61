// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::cli {

/// Writes the viewer as one HTML file that shows a light field, called `truth_name`, beside its reconstruction. Fails
/// with kIo, with kUnsupported where a browser lacks the memory for the views, and with kMissingDependency where
/// has_viewer() is false.
[[nodiscard]] Result<void> write_comparison_page(const std::filesystem::path& path, const lightfield::LightField& truth,
                                                 const lightfield::LightField& reconstruction);

}  // namespace e2lf::cli
