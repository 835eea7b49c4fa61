// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/events/byte_source.h"

namespace e2lf::events {

/// Whether a name is of the form tcp://ADDRESS:PORT.
[[nodiscard]] bool is_tcp_name(const std::string& name);

/// Connects to a sender of recording bytes, e.g. tcp://127.0.0.1:5000 (numeric IPv4 address). Fails with kInvalidValue
/// (not of that form) and kIo (nobody listens there).
[[nodiscard]] Result<std::unique_ptr<ByteSource>> open_tcp_source(const std::string& name);

/// A file, "-" for standard input, or tcp://ADDRESS:PORT.
[[nodiscard]] Result<std::unique_ptr<ByteSource>> open_any_source(const std::string& name);

}  // namespace e2lf::events
