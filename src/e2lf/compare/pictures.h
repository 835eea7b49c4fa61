// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::compare {

/// How a light field looks: its first corner view with the middle enlarged in an inset, below it the horizontal EPI of
/// the middle row. With a truth of the same shape, the error of that view beside it: black is none, white 0.2 and more.
/// Views wider than 320 px are shrunk.
[[nodiscard]] lightfield::Image look(const lightfield::LightField& field, const lightfield::LightField* truth);

}  // namespace e2lf::compare
