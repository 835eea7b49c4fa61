// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/base/result.h"
#include "e2lf/lightfield/image.h"

namespace e2lf::film {

/// An SVG drawing as a picture in colour, so wide, by the decoder of FFmpeg's libraries (librsvg); its height follows.
/// What is transparent is black. Fails with kMissingDependency (a build without the libraries, or these without the
/// decoder) and kFormat.
[[nodiscard]] Result<lightfield::Image> draw_svg(const std::string& svg, size_t width);

}  // namespace e2lf::film
