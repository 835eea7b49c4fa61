// SPDX-License-Identifier: MIT
#pragma once

namespace e2lf::bench {

/// The peak arithmetic throughput of this machine in operations per second (a multiply-add is two), measured by loops
/// that do nothing else.
struct Peak {
  double float32_flops = 0.0;
  double bfloat16_flops = 0.0;  ///< 0 if the CPU has no bfloat16 products
};

/// Measures the peak with num_threads() threads and the instruction set in use, as the best of several short loops
/// (half a second in total).
[[nodiscard]] Peak measure_peak();

}  // namespace e2lf::bench
