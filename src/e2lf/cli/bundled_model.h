// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>

namespace e2lf::cli {

/// The model file that comes with e2lf, e2lf-n4.safetensors: in models/ of the source tree this binary was built from,
/// or in ../share/e2lf/models beside an installed binary. Nothing when neither is there.
[[nodiscard]] std::optional<std::filesystem::path> bundled_model();

}  // namespace e2lf::cli
