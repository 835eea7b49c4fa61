// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/event_images.h"

namespace e2lf::capture {

/// The colour filters over each block of 2x2 pixels, row by row: 0 is red, 1 green, 2 blue. "rggb" is the usual one.
struct ColourFilter {
  std::array<size_t, 4> channels = {0, 1, 1, 2};
  bool operator==(const ColourFilter&) const = default;
};

/// Of four letters r, g and b, each of which is there. Fails with kInvalidValue.
[[nodiscard]] Result<ColourFilter> colour_filter_from_name(const std::string& name);

/// The event images of every second pixel of every second row, those behind filter `place` (0 to 3) of each block.
/// Sizes that are odd break the contract.
[[nodiscard]] EventImages behind_filter(const EventImages& images, size_t place);

}  // namespace e2lf::capture
