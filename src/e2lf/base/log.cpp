// SPDX-License-Identifier: MIT
#include "e2lf/base/log.h"

#include <mutex>
#include <utility>

namespace e2lf {
namespace {

struct LogState {
  std::mutex mutex;
  LogSink sink;
};

LogState& log_state() {
  static LogState state;
  return state;
}

void log(LogLevel level, const std::string& message) {
  LogState& state = log_state();
  const std::lock_guard lock(state.mutex);
  if (state.sink) state.sink(level, message);
}

}  // namespace

LogSink set_log_sink(LogSink sink) {
  LogState& state = log_state();
  const std::lock_guard lock(state.mutex);
  return std::exchange(state.sink, std::move(sink));
}

void log_info(const std::string& message) {
  log(LogLevel::kInfo, message);
}
void log_warning(const std::string& message) {
  log(LogLevel::kWarning, message);
}

}  // namespace e2lf
