// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "e2lf/kernels/elements.h"

namespace e2lf::engine {

using kernels::element_size, kernels::ElementType, kernels::kChannelMultiple, kernels::kTileSize;
using kernels::padded_channels, kernels::round_up, kernels::with_element;

/// Kernels read up to this many pixels beyond the last one of a row for sums that they discard.
constexpr size_t kReadAhead = 8;

/// The rows of a tensor: pixel x = 0 of row y is at rows[y - first]. Pixels are [x][padded channel]. Rows above and
/// below the image exist and hold zeros, as do the pixels to the left and right of it, as far as Reach requires.
struct Rows {
  std::byte* const* rows = nullptr;
  ptrdiff_t first = 0;

  template <typename T>
  [[nodiscard]] T* row(ptrdiff_t y) const {
    return reinterpret_cast<T*>(rows[y - first]);
  }
};

/// The input rows that a layer reads: output rows [begin, end) need rows [begin * down / up - before, ceil(end * down /
/// up) + after), and likewise for columns. A kernel may also read kTileSize - 1 further columns and rows, which exist
/// in the same way, and 5 * down pixels after them in each row, which may hold any values because their sums are
/// discarded.
struct Reach {
  size_t before = 0;
  size_t after = 0;
  size_t down = 1;
  size_t up = 1;
};

/// The rows [begin, end) of the output of a layer, to be computed from rows of its inputs.
struct Strip {
  std::vector<Rows> inputs;
  Rows residual;
  Rows output;
  size_t begin = 0;  ///< a multiple of kTileSize
  size_t end = 0;
  size_t width = 0;   ///< width of the output, in its own pixels
  size_t height = 0;  ///< height of the whole output
};

/// The code that computes one layer. A strip is divided into blocks, which threads take one after another. The result
/// of a block depends only on the block, so that it is bit-identical for any number of threads.
class Kernel {
 public:
  virtual ~Kernel() = default;

  [[nodiscard]] virtual std::string describe() const = 0;

  /// Returns the rows that it reads of inputs for which needs_all() is false: by default, those at the same place.
  [[nodiscard]] virtual Reach reach() const { return {}; }

  /// Returns true if every output row needs all rows of an input, without the zeros beside them.
  [[nodiscard]] virtual bool needs_all(size_t /*input*/) const { return false; }

  /// Returns true if a strip must be as wide as the image.
  [[nodiscard]] virtual bool needs_whole_rows() const { return false; }

  /// Returns a kernel that computes only these channels of the output, bit-identically; null if this saves nothing.
  [[nodiscard]] virtual std::unique_ptr<Kernel> with_outputs(std::span<const size_t> /*channels*/) const {
    return nullptr;
  }

  /// Returns the number of bytes of scratch memory (64-byte aligned) that each thread needs.
  [[nodiscard]] virtual size_t scratch_bytes() const { return 0; }

  /// Returns the number of blocks of a strip: by default, one for each row.
  [[nodiscard]] virtual size_t num_blocks(const Strip& strip) const { return strip.end - strip.begin; }
  virtual void run_block(const Strip& strip, size_t block, std::byte* scratch) const = 0;
};

}  // namespace e2lf::engine
