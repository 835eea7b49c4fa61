// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/learn/run/report_files.h"

namespace e2lf::learn {

/// What the command line does. No torch type appears here and no torch exception leaves: they become kInternal.
/// `overrides` are "a.b=value" on the configuration. `keep_going` returning false stops after a checkpoint
/// (kCancelled). Reports tell of a run that was stopped, too.

/// Starts a run in a folder that does not hold one yet (kExists), and exports its model at the end. Returns the model's
/// file.
[[nodiscard]] Result<std::filesystem::path> train(const std::filesystem::path& config, const std::filesystem::path& run,
                                                  const std::vector<std::string>& overrides = {},
                                                  const ProgressFn& progress = {},
                                                  const std::function<bool()>& keep_going = {},
                                                  const ReportFiles& reports = {});

/// Continues a run from its last checkpoint, and exports its model at the end. Returns the model's file.
[[nodiscard]] Result<std::filesystem::path> resume(const std::filesystem::path& run,
                                                   const std::vector<std::string>& overrides = {},
                                                   const ProgressFn& progress = {},
                                                   const std::function<bool()>& keep_going = {},
                                                   const ReportFiles& reports = {});

/// The averaged weights of the last checkpoint as a model file. Fails with kExists when it is there and `overwrite` is
/// false, and with kInvalidValue where it is a file that the run needs, overwritten or not.
[[nodiscard]] Result<void> export_run(const std::filesystem::path& run, const std::filesystem::path& model,
                                      bool overwrite);

/// A table (tab-separated text) of PSNR and events per pixel of the last checkpoint on scenes of the run's data: at the
/// nominal noise and without noise.
[[nodiscard]] Result<std::string> evaluate_run(const std::filesystem::path& run, const std::vector<std::string>& scenes,
                                               const std::vector<std::string>& overrides = {});

}  // namespace e2lf::learn
