// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <csignal>
#include <mutex>
#include <thread>

#include "e2lf/base/progress.h"

namespace e2lf::cli {

/// Requests a stop after the given number of seconds. The destructor withdraws the request, so that the exit code does
/// not report a signal.
class Deadline {
 public:
  explicit Deadline(double seconds) {
    if (seconds <= 0) return;
    thread_ = std::jthread([this, seconds](const std::stop_token& is_over) {
      std::mutex mutex;
      std::unique_lock lock(mutex);
      std::condition_variable_any().wait_for(lock, is_over, std::chrono::duration<double>(seconds),
                                             [] { return false; });
      if (is_over.stop_requested() || stop_requested()) return;
      has_passed_ = true;
      request_stop(SIGTERM);
    });
  }
  Deadline(const Deadline&) = delete;
  Deadline& operator=(const Deadline&) = delete;
  ~Deadline() {
    thread_ = {};
    if (has_passed_) request_stop(0);
  }

 private:
  bool has_passed_ = false;
  std::jthread thread_;
};

}  // namespace e2lf::cli
