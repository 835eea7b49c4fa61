// SPDX-License-Identifier: MIT
#pragma once

namespace e2lf {

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

}  // namespace e2lf
