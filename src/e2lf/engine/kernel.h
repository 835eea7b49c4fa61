// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "e2lf/kernels/elements.h"
#include "e2lf/kernels/winograd_points.h"

namespace e2lf::engine {

using kernels::element_size, kernels::ElementType, kernels::kChannelMultiple, kernels::kTileSize;
using kernels::padded_channels, kernels::round_up;

/// Rows of one tensor: row y begins (its pixel x = 0) at rows[y - first]. Pixels are [x][padded channel]. Rows outside
/// the image are there too and hold zeros, as do the pixels to the left and right of it (as many as Reach asks for).
struct Rows {
  std::byte* const* rows = nullptr;
  ptrdiff_t first = 0;

  template <typename T>
  [[nodiscard]] T* row(ptrdiff_t y) const {
    return reinterpret_cast<T*>(rows[y - first]);
  }
};

/// Which input rows a layer reads: output rows [begin, end) need [begin * down / up - before, ceil(end * down / up) +
/// after). Columns are the same. A kernel may also read kTileSize - 1 columns and rows further, for which the same
/// holds, and behind them in each row 5 * down pixels, whatever they hold, for sums that it drops.
struct Reach {
  size_t before = 0;
  size_t after = 0;
  size_t down = 1;
  size_t up = 1;
};

/// Rows [begin, end) of a layer's output, to be computed from rows of its inputs.
struct Strip {
  std::vector<Rows> inputs;
  Rows residual;
  Rows output;
  size_t begin = 0;  ///< a multiple of kTileSize
  size_t end = 0;
  size_t width = 0;   ///< of the output, in its own pixels
  size_t height = 0;  ///< of the whole output
};

/// The code that computes one layer. A strip is cut into blocks that threads take one after another; what a block
/// writes depends on nothing but the block, so any number of threads gives the same bits.
class Kernel {
 public:
  virtual ~Kernel() = default;

  [[nodiscard]] virtual std::string describe() const = 0;
  [[nodiscard]] virtual Reach reach() const = 0;  ///< of inputs that needs_all() says nothing of

  /// Whether any row of output needs all rows of an input, without zeros beside them.
  [[nodiscard]] virtual bool needs_all(size_t /*input*/) const { return false; }

  /// Whether a strip must be as wide as the image.
  [[nodiscard]] virtual bool needs_whole_rows() const { return false; }

  /// Bytes of scratch memory (64-byte aligned) that each thread needs.
  [[nodiscard]] virtual size_t scratch_bytes() const { return 0; }

  [[nodiscard]] virtual size_t num_blocks(const Strip& strip) const = 0;
  virtual void run_block(const Strip& strip, size_t block, std::byte* scratch) const = 0;
};

}  // namespace e2lf::engine
