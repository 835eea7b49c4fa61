// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/model/model.h"

namespace e2lf::bench {

/// How long runs of a peer took, and its name with the version.
struct PeerRuns {
  std::string name;
  std::vector<double> seconds;
};

/// Runs an exported model on event images of noise in ONNX Runtime, in a process of Node.js with so many threads,
/// `runs` times after a first one. `packages` is a folder with the npm package onnxruntime-node. Fails as
/// model::onnx_file() does, with kMissingDependency (no Node.js, no package) and kIo.
[[nodiscard]] Result<PeerRuns> run_onnx_runtime(const model::Model& model, size_t height, size_t width, size_t runs,
                                                int threads, const std::filesystem::path& packages);

}  // namespace e2lf::bench
