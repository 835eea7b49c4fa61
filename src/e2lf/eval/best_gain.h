// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/lightfield/light_field.h"

namespace e2lf::eval {

/// Returns the factor g that minimises the squared error between the truth and g times the reconstruction, so that a
/// method made for another brightness is not penalised for that alone. It is 0 for a black reconstruction. Different
/// shapes break the contract.
[[nodiscard]] float best_gain(const lightfield::LightField& truth, const lightfield::LightField& reconstruction);

}  // namespace e2lf::eval
