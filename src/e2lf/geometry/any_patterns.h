// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "e2lf/geometry/aperture.h"
#include "e2lf/model/composition.h"

namespace e2lf::geometry {

/// Adapts a network for any patterns (model::is_for_any_patterns()) to these, in the order in which they are shown: the
/// result is an ordinary network for their event images. The first layers of such a network read the central picture
/// and its derivatives, which are linear in the pictures behind the patterns, and features of each picture, which all
/// pictures make in the same way; both are built into its weights, and the offsets of plane-sweep are the centroids of
/// the patterns. Networks that follow or read such a network (Model::open_guide) are composed with the adapted one; if
/// views follow one for fixed patterns, only its offsets become those of these patterns, which must be similar. For
/// a whole cycle, the result for a network of disparity on moved pictures is the network that moves them. Fails with
/// kInvalidValue if these views were trained for other patterns, with kUnsupported for other networks, with kShape if
/// its weights do not fit together, and as describe_aperture() does.
[[nodiscard]] Result<model::Model> for_patterns(const model::Model& model, const capture::Codes& codes);

/// Composes views with the network for any patterns that they follow (Model::open_guide), if their own patterns are
/// known; other models are returned as they are. Fails as for_patterns() does.
[[nodiscard]] Result<model::Model> for_own_patterns(model::Model model);

/// Returns how networks that read InputKind::kMoved read the pictures behind `codes`, for a network of disparity with
/// the input groups `input`. Fails with kUnsupported if `codes` are those of a whole cycle, and as describe_aperture()
/// does.
[[nodiscard]] Result<model::MovedInput> moved_input(const capture::Codes& codes,
                                                    const std::vector<model::InputGroup>& input);

/// The number of the plane of InputKind::kMoved that holds the disparity; the next one holds the logarithm of its
/// scale. Both are multiplied by kDepthScale.
inline constexpr size_t kFirstDepthPlane = model::kMovedPlanes - kApertureConstants - model::kDepthOutputs;
inline constexpr float kDepthScale = 0.3F;

/// Composes a network that reads moved pictures (model::reads_moved_pictures()) with one of disparity that was adapted
/// to `codes`. Fails with kUnsupported if it gives fewer views than the patterns have cells, and as moved_input() and
/// model::on_moved_pictures() do.
[[nodiscard]] Result<model::Model> composed_for_patterns(model::Model network, model::Model disparity,
                                                         const capture::Codes& codes);

}  // namespace e2lf::geometry
