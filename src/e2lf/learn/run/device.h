// SPDX-License-Identifier: MIT
#pragma once

#include <c10/core/Device.h>
#include <string>

#include "e2lf/base/result.h"

namespace e2lf::learn {

/// Opens the device that a configuration names: "cpu", "cuda" or "cuda:1". Fails with kInvalidValue (another name) and
/// kUnsupported (this build of torch, or this machine, has no CUDA device with that number).
[[nodiscard]] Result<c10::Device> open_device(const std::string& name);

}  // namespace e2lf::learn
