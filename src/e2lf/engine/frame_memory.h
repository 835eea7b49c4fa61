// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "e2lf/engine/row_memory.h"

namespace e2lf::engine {

/// A tensor of a whole image, stored row by row with the zeros beside each row that kernels read.
struct WholeTensor {
  AlignedBuffer memory;
  size_t row_stride = 0;  ///< in bytes

  [[nodiscard]] std::byte* row(size_t y) const { return memory.data() + y * row_stride; }
};

/// The states of a plan for the previous frame and for the current one. It is empty before the first frame.
struct FrameMemory {
  std::vector<WholeTensor> before, now;  ///< one per state
  size_t height = 0, width = 0;          ///< size of the image
  RowPool rows;                        ///< rows of all other tensors; kept, because new memory would have to be cleared
  std::vector<AlignedBuffer> scratch;  ///< one buffer for each thread, kept for the same reason

  void end_frame() { before.swap(now); }
};

}  // namespace e2lf::engine
