// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"

namespace e2lf::capture {

/// The colours of a filter mosaic over each block of 2x2 pixels, row by row: 0 is red, 1 green and 2 blue. The default
/// is "rggb".
struct ColourFilter {
  std::array<size_t, 4> channels = {0, 1, 1, 2};
  bool operator==(const ColourFilter&) const = default;
};

/// Parses four letters r, g and b, each of which must occur. Fails with kInvalidValue.
[[nodiscard]] Result<ColourFilter> colour_filter_from_name(const std::string& name);

/// Returns the event images of the pixels behind filter `place` (0 to 3) of each 2x2 block, at half the width and
/// height, in the same memory. An odd width or height breaks the contract.
[[nodiscard]] PlanesView<const int16_t> behind_filter(const PlanesView<const int16_t>& images, size_t place);

}  // namespace e2lf::capture
