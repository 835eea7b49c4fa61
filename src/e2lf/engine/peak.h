// SPDX-License-Identifier: MIT
#pragma once

namespace e2lf::engine {

/// Arithmetic that this machine can do, in operations (a multiply-add is two) per second, from loops that do nothing
/// else.
struct Peak {
  double float32_flops = 0.0;
  double bfloat16_flops = 0.0;  ///< 0 where the CPU has none
};

/// Measures with num_threads() threads and the instruction set in use, the best of several short loops (half a second
/// in all).
[[nodiscard]] Peak measure_peak();

}  // namespace e2lf::engine
