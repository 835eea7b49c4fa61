// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/capture/patterns/codes.h"

namespace e2lf::learn {

/// Reads the patterns of a model file, a bundled model or a JSON file. (Other formats would need libraries that a
/// machine with only torch may lack.) Fails with kShape unless the file has patterns of 8x8 cells, and as read_model()
/// and codes_from_json() do.
[[nodiscard]] Result<capture::Codes> read_pattern_set(const std::string& name);

}  // namespace e2lf::learn
