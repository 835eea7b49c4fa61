// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "e2lf/engine/kernel.h"

namespace e2lf::engine {

/// Interleaves a row of planes: pixel x of channel c is at from[c * plane + x], goes to element x * padded channels + c
/// of `row`. Padding channels become zero.
void read_planes(const float* from, size_t plane, size_t channels, size_t width, ElementType type, std::byte* row);

/// The way back: element x * padded channels + c of `row` goes to to[c * plane + x].
void write_planes(const std::byte* row, size_t channels, size_t width, ElementType type, float* to, size_t plane);

}  // namespace e2lf::engine
