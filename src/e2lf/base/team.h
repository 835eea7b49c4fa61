// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>

namespace e2lf {

/// Calls body(member) at once on this thread, as member 0, and on helpers, as members 1 to threads - 1. Returns when
/// this thread's call and those that have begun have ended. A helper that the system gives no core before then is not
/// waited for and is not called, so that a busy machine holds nothing up. So members take their work from a common
/// counter until none is left. There are 255 helpers at most, and fewer where the system has no more threads.
///
/// An exception of a member is rethrown here. Within a member a call runs on that member alone. Helpers belong to the
/// calling thread and end with it; after a fork the child gets helpers of its own. `threads` = 0 breaks the contract.
void run_team(size_t threads, const std::function<void(size_t member)>& body);

}  // namespace e2lf
