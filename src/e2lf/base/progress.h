// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>

namespace e2lf {

/// Is called by long operations with the number of parts done and the total, from one thread at a time. An empty
/// function reports nothing.
using ProgressFn = std::function<void(size_t done, size_t total)>;

/// Returns the function that reports the progress of one pass as part of several equal passes.
[[nodiscard]] inline ProgressFn progress_of_pass(const ProgressFn& progress, size_t pass, size_t passes) {
  if (!progress) return {};
  return [=](size_t done, size_t total) { progress(pass * total + done, passes * total); };
}

/// Returns true if a stop was requested. Long operations ask this between their units (a batch of events, a cycle, a
/// step) and then end early with what is complete.
[[nodiscard]] bool stop_requested();

/// Returns the number of the signal that requested the stop, or 0 if there was none.
[[nodiscard]] int stop_signal();

/// Installs handlers so that the first SIGINT or SIGTERM requests a stop. A second one ends the process at once, as by
/// default.
void stop_on_signals();

/// Requests a stop as `signal` would, or withdraws the request if `signal` is 0. For tests.
void request_stop(int signal);

/// Returns the seconds that have passed since `begin`.
inline double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace e2lf
