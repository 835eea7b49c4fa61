// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/base/result.h"

namespace e2lf::recordings {

/// Connects to a sender of recording bytes, e.g. tcp://127.0.0.1:5000 (numeric IPv4 address), and returns the
/// descriptor, which the caller closes. Fails with kInvalidValue (not of this form) and kIo (no program listens there).
[[nodiscard]] Result<int> connect_tcp(const std::string& name);

}  // namespace e2lf::recordings
