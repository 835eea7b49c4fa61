// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::compare {

/// Draws a preview of a light field: its upper left view with an enlarged inset of the middle and, below it, the
/// horizontal EPI of the middle row. If a truth of the same shape is given, the error of this view is drawn beside it,
/// from black for none to white for 0.2 and more. Views wider than 320 px are shrunk.
[[nodiscard]] lightfield::Image look(const lightfield::LightField& field, const lightfield::LightField* truth);

}  // namespace e2lf::compare
