// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <utility>

#include "e2lf/base/log.h"

namespace e2lf {

/// Collects the messages of the library during its lifetime.
class TestLog {
 public:
  TestLog() : previous_(set_log_sink([this](LogLevel, const std::string& message) { text_ += message + "\n"; })) {}
  TestLog(const TestLog&) = delete;
  TestLog& operator=(const TestLog&) = delete;
  ~TestLog() { set_log_sink(std::move(previous_)); }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
  LogSink previous_;
};

}  // namespace e2lf
