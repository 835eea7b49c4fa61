// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::compare {

/// Draws a preview of a light field: its upper left view with an enlarged inset of the middle and, below it, the
/// horizontal EPI of the middle row. If a truth of the same shape is given, the error of this view is drawn beside it,
/// from black for none to white for 0.2 and more. Views wider than 320 px are shrunk. Unless `disparity` is empty, it
/// is drawn below in the colours of depth::colour_picture(), over the range of `true_disparity`, or its own if that is
/// empty.
[[nodiscard]] lightfield::Image look(const lightfield::LightField& field, const lightfield::LightField* truth,
                                     const lightfield::Image& disparity = {},
                                     const lightfield::Image& true_disparity = {});

}  // namespace e2lf::compare
