// SPDX-License-Identifier: MIT
#pragma once

#include <c10/core/Device.h>
#include <string>

#include "e2lf/base/result.h"

namespace e2lf::learn {

/// The device that a configuration names: "cpu", "cuda" or "cuda:1". Fails with kInvalidValue for another name and
/// kUnsupported when this torch or this machine has no CUDA device of that number.
[[nodiscard]] Result<c10::Device> open_device(const std::string& name);

}  // namespace e2lf::learn
