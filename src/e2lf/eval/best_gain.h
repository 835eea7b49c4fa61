// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/lightfield/light_field.h"

namespace e2lf::eval {

/// The factor g of the least squared error between the truth and g times the reconstruction: so a method that was made
/// for another brightness does not lose by that alone. 0 for a reconstruction that is black. Different shapes break the
/// contract.
[[nodiscard]] float best_gain(const lightfield::LightField& truth, const lightfield::LightField& reconstruction);

}  // namespace e2lf::eval
