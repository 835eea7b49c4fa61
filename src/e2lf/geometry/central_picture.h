// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/model/composition.h"

/// Light fields for any patterns from a sharp central picture.
namespace e2lf::geometry {

/// Returns how networks of the central picture read the pictures behind `codes`, for a network of disparity with the
/// input groups `input`. Fails with kUnsupported if `codes` are those of a whole cycle, and as describe_aperture()
/// does.
[[nodiscard]] Result<model::CentralInput> central_input(const capture::Codes& codes,
                                                        const std::vector<model::InputGroup>& input);

/// Composes a network of the central picture (model::is_picture_network()) with one of disparity that was adapted to
/// `codes`. Fails as central_input() and model::rendered() do.
[[nodiscard]] Result<model::Model> rendered_for_patterns(model::Model picture, model::Model disparity,
                                                         const capture::Codes& codes);

}  // namespace e2lf::geometry
