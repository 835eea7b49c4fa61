// SPDX-License-Identifier: MIT
#pragma once

namespace e2lf {

/// Long work asks this between its units (a batch of events, a cycle, a step) and ends early, with what is complete.
[[nodiscard]] bool stop_requested();

/// Which signal asked for it; 0 = none.
[[nodiscard]] int stop_signal();

/// Makes the first SIGINT or SIGTERM ask for a stop. A second one ends the process at once, as by default.
void stop_on_signals();

/// Asks for a stop as a signal does, or takes that back with 0; for tests.
void request_stop(int signal);

}  // namespace e2lf
