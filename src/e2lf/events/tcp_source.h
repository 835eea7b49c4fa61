// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/events/byte_source.h"
#include "e2lf/events/recording.h"

namespace e2lf::events {

/// Whether a name is of the form tcp://ADDRESS:PORT.
[[nodiscard]] bool is_tcp_name(const std::string& name);

/// Connects to a sender of recording bytes, e.g. tcp://127.0.0.1:5000 (numeric IPv4 address). Fails with kInvalidValue
/// (not of that form) and kIo (nobody listens there).
[[nodiscard]] Result<std::unique_ptr<ByteSource>> open_tcp_source(const std::string& name);

/// open_recording() of a file, of "-" for standard input, or of tcp://ADDRESS:PORT.
[[nodiscard]] Result<std::unique_ptr<RecordingReader>> open_named_recording(const std::string& name,
                                                                            const OpenOptions& options = {});

}  // namespace e2lf::events
