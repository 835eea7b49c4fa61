// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "e2lf/capture/measurement/event_images.h"

namespace e2lf::live {

/// The most cycles of a still scene that are summed.
inline constexpr size_t kMostCycles = 16;

/// Sums the event images of the last cycles of a still scene. Its memory is bounded by kMostCycles of them.
class CycleSum {
 public:
  /// Adds the images of a cycle and replaces them by the sum over the last `wanted` (1 to kMostCycles) cycles, or over
  /// as many as there have been. Returns their number. Sums are limited to the range of int16. Images of another shape
  /// than the previous ones begin anew.
  size_t add(capture::EventImages& images, size_t wanted);

 private:
  std::deque<capture::EventImages> last_;
  std::vector<int32_t> sum_;
};

}  // namespace e2lf::live
