// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/base/result.h"
#include "e2lf/model/model.h"

/// Light fields for any patterns; internal to this module.
namespace e2lf::geometry {

/// Composes a network of the central picture (model::is_picture_network()) with one of disparity that was adapted to
/// `codes`. Fails with kUnsupported if `codes` are those of a whole cycle, and as
/// describe_aperture() and model::rendered() do.
[[nodiscard]] Result<model::Model> rendered_for_patterns(model::Model picture, model::Model disparity,
                                                         const capture::Codes& codes);

}  // namespace e2lf::geometry
