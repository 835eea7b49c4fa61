// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::program {

/// Returns the arguments of this process after the name of the program.
[[nodiscard]] std::vector<std::string> own_arguments();

/// Replaces this process by the program of this name in the same folder. Returns only if it is missing, with
/// kMissingDependency and the reason, followed by `remedy`.
[[nodiscard]] Error continue_as(const std::string& name, std::vector<std::string> arguments, const std::string& remedy);

/// Fails with kMissingDependency if this machine does not have the device, see engine::EngineOptions. The program with
/// torch continues with the arguments of this process if only it knows the kind of the device.
[[nodiscard]] Result<void> require_device(const std::string& device);

}  // namespace e2lf::program
