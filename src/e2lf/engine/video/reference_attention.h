// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/engine/video/reference_cells.h"

/// Parts of the reference; not for other modules. All in double precision.
namespace e2lf::engine {

/// model::Op::kAttention.
[[nodiscard]] ReferencePlanes reference_attention(const ReferencePlanes& queries, const ReferencePlanes& keys,
                                                  const ReferencePlanes& values, size_t heads);

/// model::Op::kLayerNorm.
[[nodiscard]] ReferencePlanes reference_layer_norm(const ReferencePlanes& input, const ReferenceKernel& weights);

/// What model::Op::kPositionCode adds to a value.
[[nodiscard]] float reference_position_code(const ReferencePlanes& input, size_t c, size_t y, size_t x);

}  // namespace e2lf::engine
