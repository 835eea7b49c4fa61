// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "e2lf/base/result.h"

namespace e2lf::fuzz {

/// Writes seeds for the readers of light fields, models, patterns, schedules, event images and settings to
/// `folder`/<target>/.
[[nodiscard]] Result<void> write_reader_seeds(const std::filesystem::path& folder);

}  // namespace e2lf::fuzz
