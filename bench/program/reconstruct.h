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
  size_t runs = 3;                      ///< of each precision and of each peer; figures are medians
  std::optional<model::Model> model;    ///< absent: the paper's network for N = 4 with random weights
  std::filesystem::path onnx_packages;  ///< with the npm package onnxruntime-node, a peer; empty = without it
};

/// Measures the speed of the reconstruction network on an image of noise: every precision the CPU has, the machine's
/// peak in a multiply-add loop, and the peers that this build has, in this same process with the same threads: for the
/// paper's network oneDNN in float32 and bfloat16, with the instruction set in use, and libtorch in float32; for all
/// networks ONNX Runtime in a process of its own. Operations count multiply-adds of the network as written, twice each.
/// Fails as Engine::create does and with kInvalidValue (no runs, a size that is not a multiple of what the network
/// needs; the location names the option).
///
/// {"image": [720, 1280], "threads": 2, "isa": "avx512", "gmac": 873,
///  "peak_gflops": {"float32": .., "bfloat16": ..},
///  "float32": {"seconds": {"median", "min", "max"}, "gflops", "share_of_peak", "kernels": [..], "times_onednn",
///              "times_libtorch", "times_onnx_runtime"},
///  "bfloat16": the same with "snr_to_float32_db", "int16": the same, with its share of the peak of float32,
///  "peak_memory_mib": of the process after the float32 runs,
///  "peers": {"onednn": {"name", "float32": {"seconds": {..}, "gflops", "share_of_peak", "snr_to_float32_db"},
///                       "bfloat16": {..}}, "libtorch": {..}, "onnx_runtime": {..}},
///   each {"absent": "why"} where it did not run}
/// The speed of bfloat16 is compared with that of a peer in bfloat16 if it has it, and otherwise in float32.
[[nodiscard]] Result<Json> bench_reconstruct(const ReconstructBench& options, const ProgressFn& progress = {});

}  // namespace e2lf::bench
