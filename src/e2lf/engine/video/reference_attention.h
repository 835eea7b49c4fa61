// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/engine/video/reference_cells.h"

/// Internal parts of the reference; not for use by other modules. All of them compute in double precision.
namespace e2lf::engine {

/// Computes model::Op::kAttention.
[[nodiscard]] ReferencePlanes reference_attention(const ReferencePlanes& queries, const ReferencePlanes& keys,
                                                  const ReferencePlanes& values, size_t heads);

/// Computes model::Op::kLayerNorm.
[[nodiscard]] ReferencePlanes reference_layer_norm(const ReferencePlanes& input, const ReferenceKernel& weights);

/// Returns the value that model::Op::kPositionCode adds.
[[nodiscard]] float reference_position_code(const ReferencePlanes& input, size_t c, size_t y, size_t x);

}  // namespace e2lf::engine
