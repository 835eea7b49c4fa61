// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>

namespace e2lf {

enum class LogLevel { kDebug, kInfo, kWarning };

/// Receives the library's messages; the library itself never prints.
using LogSink = std::function<void(LogLevel level, const std::string& message)>;

/// Installs the sink and returns the previous one; an empty sink (the default) is silence. Call before threads start.
LogSink set_log_sink(LogSink sink);

void log_debug(const std::string& message);
void log_info(const std::string& message);
void log_warning(const std::string& message);

}  // namespace e2lf
