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
  uint64_t batch = 4;  ///< of 64x64x8x8
  uint64_t steps = 5;  ///< measured, after two that warm up; the figure is their median
};

/// One way to do a job, and how fast it goes.
struct BenchmarkRow {
  std::string job, name, precision;
  double samples_per_s = 0;
  double ratio = 1;  ///< to the first row of the same job
};

/// Two jobs. Training: a plain libtorch loop of the paper's networks (the peer; left out where its module is not beside
/// the program), this trainer with the same networks, and with the network of the default configuration; whole steps on
/// samples of 64x64x8x8, here synthesised; bfloat16 where the CPU has it. Synthesis: the views (96x96x8x8) of
/// procedural surfaces with torch's sampling (the peer), and as e2lf renders them. Fails as Trainer::create does.
[[nodiscard]] Result<std::vector<BenchmarkRow>> benchmark_training(const BenchmarkOptions& options,
                                                                   const ProgressFn& progress = {});

}  // namespace e2lf::learn
