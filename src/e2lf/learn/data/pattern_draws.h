// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "e2lf/capture/patterns/codes.h"
#include "e2lf/learn/data/draws.h"

namespace e2lf::learn {

/// Draws black and `num_lit` lit patterns of 8x8 cells in [0, 1]: compact apertures of any outline, parts of the
/// aperture beside lines, or patterns of one of the `known` sets (which may contain black ones), with the edges,
/// leakage and transmissions of real displays. The centroids of the lit ones differ.
[[nodiscard]] capture::Codes draw_patterns(size_t num_lit, const std::vector<capture::Codes>& known, Draws& draws);

}  // namespace e2lf::learn
