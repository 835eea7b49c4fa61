// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/files/options.h"
#include "e2lf/model/model.h"

namespace e2lf::bench {

struct ReconstructBench {
  size_t height = 720;
  size_t width = 1280;
  size_t runs = 3;                    ///< of each precision and of the peer; figures are medians
  std::optional<model::Model> model;  ///< absent: the paper's network for N = 4 with random weights
  bool with_peer = true;              ///< libtorch; needs the paper's network
  /// The module with the peer; empty = e2lf_torch_peer.so beside this program.
  std::filesystem::path peer_module;
  std::filesystem::path onnx_packages;  ///< with the npm package onnxruntime-node, the second peer; empty = without it
};

/// Measures the speed of the reconstruction network on an image of noise: every precision the CPU has, beside it the
/// machine's peak in a multiply-add loop and, where the build has one, libtorch in float32 in this same process with
/// the same threads. Operations count multiply-adds of the network as written, twice each. Fails as Engine::create
/// does and with kInvalidValue (no runs, a size that is not a multiple of what the network needs; the location names
/// the option).
///
/// {"image": [720, 1280], "threads": 2, "isa": "avx512", "gmac": 873,
///  "peak_gflops": {"float32": .., "bfloat16": ..},
///  "float32": {"seconds": {"median", "min", "max"}, "gflops", "share_of_peak", "ratio_to_peer", "kernels": [..]},
///  "bfloat16": {.., "snr_to_float32_db"},
///  "int16": the same, with its share of the peak of float32,
///  "peak_memory_mib": of the process after the float32 runs,
///  "onnx_runtime": {"name", "seconds": {..}, "gflops"} or {"absent": "why"}, if it is asked for; the precisions then
///  have "ratio_to_onnx_runtime", "peer": {"name", "seconds": {..}, "gflops", "largest_difference"} or {"absent":
///  "why"}}
[[nodiscard]] Result<Json> bench_reconstruct(const ReconstructBench& options, const ProgressFn& progress = {});

}  // namespace e2lf::bench
