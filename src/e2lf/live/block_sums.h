// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "e2lf/capture/measurement/event_images.h"

namespace e2lf::live {

/// Computes event images of a lower resolution: each count is the sum over a block of side x side pixels (2 or 4),
/// limited to the range of int16. Odd last rows and columns are left out. `sums` is resized if its shape differs,
/// otherwise its memory is used again. A network takes the sums as those of side^2 cycles of one pixel. Images that are
/// smaller than a block break the contract.
void sum_blocks(const capture::EventImages& images, size_t side, capture::EventImages& sums);

}  // namespace e2lf::live
