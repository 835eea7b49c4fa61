// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::cli {

/// Writes a self-contained HTML file in which the viewer shows a light field beside its reconstruction. Fails with kIo,
/// with kUnsupported (a browser would not have enough memory for the views), and with kMissingDependency if
/// has_viewer() is false.
[[nodiscard]] Result<void> write_comparison_page(const std::filesystem::path& path, const lightfield::LightField& truth,
                                                 const lightfield::LightField& reconstruction);

}  // namespace e2lf::cli
