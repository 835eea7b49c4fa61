// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/learn/run/config.h"

namespace e2lf::learn {

struct BenchmarkOptions {
  uint64_t batch = 4;  ///< number of samples of 64x64x8x8
  uint64_t steps = 5;  ///< measured steps, after two that warm up; the figure is their median
};

/// One implementation of a job and its speed.
struct BenchmarkRow {
  std::string job, name, precision;
  double samples_per_s = 0;
  double ratio = 1;  ///< to the first row of the same job
};

/// Measures two jobs. Training: whole steps on synthesised samples of 64x64x8x8 with a plain libtorch loop of the
/// paper's networks (the peer, omitted if its module is not beside the program), and with this trainer for the same
/// networks and for the default configuration, in float32 and, if the CPU supports it, bfloat16. Synthesis: the views
/// (96x96x8x8) of procedural surfaces with torch's sampling (the peer) and with e2lf. Fails as Trainer::create() does.
[[nodiscard]] Result<std::vector<BenchmarkRow>> benchmark_training(const BenchmarkOptions& options,
                                                                   const ProgressFn& progress = {});

}  // namespace e2lf::learn
