// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string_view>

#include "e2lf/lightfield/image.h"

namespace e2lf::depth {

/// Returns the text in DejaVu Sans, black on white, as a grey image of this height, from the ascenders to the
/// descenders. Only digits, '-', '.', ' ' and the letters of "near", "far" and "px per view step" exist; any other
/// character, and a height of 0 or above 64, breaks the contract.
[[nodiscard]] lightfield::Image text_picture(std::string_view text, size_t height);

}  // namespace e2lf::depth
