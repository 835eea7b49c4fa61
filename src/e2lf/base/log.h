// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>

namespace e2lf {

enum class LogLevel { kInfo, kWarning };

/// Receives the messages of the library, which itself never prints.
using LogSink = std::function<void(LogLevel level, const std::string& message)>;

/// Installs the sink and returns the previous one. An empty sink, the default, discards all messages. It must be called
/// before any threads are started.
LogSink set_log_sink(LogSink sink);

void log_info(const std::string& message);
void log_warning(const std::string& message);

}  // namespace e2lf
