// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/capture/patterns/codes.h"
#include "e2lf/learn/data/draws.h"

namespace e2lf::learn {

/// Draws black and `num_lit` lit patterns of 8x8 cells in [0, 1]: compact apertures of any outline, parts of the
/// aperture beside lines, or patterns of one of the `known` sets (which may contain black ones), with the edges,
/// leakage and transmissions of real displays. The centroids of the lit ones differ.
[[nodiscard]] capture::Codes draw_patterns(size_t num_lit, const std::vector<capture::Codes>& known, Draws& draws);

/// Reads the patterns of a model file, a bundled model or a JSON file. (Other formats would need libraries that a
/// machine with only torch may lack.) Fails with kShape unless the file has patterns of 8x8 cells, and as read_model()
/// and codes_from_json() do.
[[nodiscard]] Result<capture::Codes> read_pattern_set(const std::string& name);

}  // namespace e2lf::learn
