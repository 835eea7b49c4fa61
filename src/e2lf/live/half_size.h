// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "e2lf/capture/measurement/event_images.h"

namespace e2lf::live {

/// The number of pixels whose counts one pixel of half the resolution sums.
inline constexpr size_t kPixelsPerBlock = 4;

/// Computes event images of half the resolution: each count is the sum over a block of 2x2 pixels, which saturates at
/// the range of int16. An odd last row or column is left out. `half` is resized if its shape differs; otherwise its
/// memory is reused. To a network, such a sum is equivalent to the sum over kPixelsPerBlock cycles of one pixel. Both
/// sides of the images must be at least 2 pixels long.
void sum_blocks(const capture::EventImages& images, capture::EventImages& half);

}  // namespace e2lf::live
