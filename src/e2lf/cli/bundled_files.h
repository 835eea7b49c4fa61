// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace e2lf::cli {

/// A file that comes with e2lf, such as "models/e2lf-n4.safetensors": in the source tree this binary was built from, or
/// in ../share/e2lf beside an installed binary. Nothing when neither has it.
[[nodiscard]] std::optional<std::filesystem::path> bundled_file(const std::string& path);

/// The model of verbs that need one and are given none.
[[nodiscard]] std::optional<std::filesystem::path> bundled_model();

}  // namespace e2lf::cli
