// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <span>

#include "e2lf/engine/kernel.h"

namespace e2lf::engine {

/// Interleaves a row of planes: pixel x of channel c, at from[c * plane + x], is copied to element x * padded channels
/// + c of `row`. The padding channels become zero.
void read_planes(const float* from, size_t plane, size_t channels, size_t width, ElementType type, std::byte* row);

/// Does the inverse: element x * padded channels + c of `row` is copied to to[planes[c] * plane + x], or, if `planes`
/// is empty, to to[c * plane + x].
void write_planes(const std::byte* row, size_t channels, size_t width, ElementType type, float* to, size_t plane,
                  std::span<const size_t> planes);

}  // namespace e2lf::engine
