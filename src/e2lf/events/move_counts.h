// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

namespace e2lf::events {

/// to[i] += from[i], saturating; from[i] = 0. Both have one length.
void move_counts(std::span<int16_t> from, std::span<int16_t> to);

}  // namespace e2lf::events
