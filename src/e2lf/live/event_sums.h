// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::live {

/// Computes event images of a lower resolution: each count is the sum over a block of side x side pixels (2 or 4),
/// limited to the range of int16. Odd last rows and columns are left out. `sums` is resized if its shape differs,
/// otherwise its memory is used again. A network takes the sums as those of side^2 cycles of one pixel. Images that are
/// smaller than a block break the contract.
void sum_blocks(const capture::EventImages& images, size_t side, capture::EventImages& sums);

/// Maximum number of cycles of a static scene that are summed.
inline constexpr size_t kMostCycles = 16;

/// Sums the event images of the last cycles of a static scene. Memory is bounded by kMostCycles cycles.
class CycleSum {
 public:
  /// Adds the images of a cycle and replaces them by the sum over the last `wanted` cycles (1 to kMostCycles), or over
  /// all cycles if fewer were added. Returns the number of cycles in the sum. Sums saturate at the range of int16.
  /// Images whose shape differs from that of the previous ones start a new sum.
  size_t add(capture::EventImages& images, size_t wanted);

 private:
  std::deque<capture::EventImages> last_;
  std::vector<int32_t> sum_;
};

/// Returns a light field whose pixels are repeated to blocks until it has this size, of which its own size is a part:
/// the inverse of sum_blocks(). The last pixels also fill a rest.
[[nodiscard]] lightfield::LightField enlarged(const lightfield::LightField& light_field, size_t height, size_t width);

}  // namespace e2lf::live
