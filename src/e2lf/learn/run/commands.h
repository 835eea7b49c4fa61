// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"

namespace e2lf::learn {

/// The operations of the command line. No torch type appears here, and exceptions of torch are converted to kInternal
/// errors. `overrides` are settings "a.b=value" that replace those of the configuration. If `keep_going` returns false,
/// the run writes a checkpoint and fails with kCancelled.

/// Starts a run in a folder and exports its model at the end. Returns the path of the model file. Fails with kExists if
/// the folder already contains a run.
[[nodiscard]] Result<std::filesystem::path> train(const std::filesystem::path& config, const std::filesystem::path& run,
                                                  const std::vector<std::string>& overrides = {},
                                                  const ProgressFn& progress = {},
                                                  const std::function<bool()>& keep_going = {});

/// Continues a run from its last checkpoint and exports its model at the end. Returns the path of the model file.
[[nodiscard]] Result<std::filesystem::path> resume(const std::filesystem::path& run,
                                                   const std::vector<std::string>& overrides = {},
                                                   const ProgressFn& progress = {},
                                                   const std::function<bool()>& keep_going = {});

/// Exports the averaged weights of the last checkpoint as a model file; if `model` is a link, its target is written.
/// Fails with kExists if the file exists and `overwrite` is false, and with kInvalidValue if it is a file that the run
/// needs or not named .safetensors.
[[nodiscard]] Result<void> export_run(const std::filesystem::path& run, const std::filesystem::path& model,
                                      bool overwrite);

/// Evaluates the last checkpoint on scenes of the run's data, and returns a table (tab-separated text) of PSNR and
/// events per pixel, at the nominal noise and without noise.
[[nodiscard]] Result<std::string> evaluate_run(const std::filesystem::path& run, const std::vector<std::string>& scenes,
                                               const std::vector<std::string>& overrides = {});

}  // namespace e2lf::learn
