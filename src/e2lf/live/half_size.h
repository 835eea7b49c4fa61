// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "e2lf/capture/measurement/event_images.h"

namespace e2lf::live {

/// The number of pixels whose counts one pixel of half the resolution sums.
inline constexpr size_t kPixelsPerBlock = 4;

/// Computes event images of half the resolution: each count is the sum over a block of 2x2 pixels, limited to the range
/// of int16. An odd last row or column is left out. `half` is resized if its shape differs, otherwise its memory is
/// used again. A network takes the sums as those of kPixelsPerBlock cycles of one pixel. Images with a side below 2
/// pixels break the contract.
void sum_blocks(const capture::EventImages& images, capture::EventImages& half);

}  // namespace e2lf::live
