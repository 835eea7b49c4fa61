// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "e2lf/engine/aligned_buffer.h"
#include "e2lf/engine/row_pool.h"

namespace e2lf::engine {

/// A tensor of a whole image, row by row with the zeros beside each that kernels read.
struct WholeTensor {
  AlignedBuffer memory;
  size_t row_stride = 0;  ///< bytes

  [[nodiscard]] std::byte* row(size_t y) const { return memory.data() + y * row_stride; }
};

/// What a plan's states hold: of the frame before, and of the one that is being made. Empty before the first frame.
struct FrameMemory {
  std::vector<WholeTensor> before, now;  ///< one for each state
  size_t height = 0, width = 0;          ///< of the image
  RowPool rows;                          ///< of all other tensors: new memory for each frame would have to be cleared

  void end_frame() { before.swap(now); }
};

}  // namespace e2lf::engine
