// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::film {

/// Draws an SVG as a colour picture of this width by the decoder of the FFmpeg libraries (librsvg). Its height follows
/// from the aspect ratio. Transparent areas become black. Fails with kMissingDependency (a build without the libraries,
/// or libraries without the decoder) and kFormat.
[[nodiscard]] Result<lightfield::Image> draw_svg(const std::string& svg, size_t width);

}  // namespace e2lf::film
