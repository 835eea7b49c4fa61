// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>

namespace e2lf {

/// Returns the number of threads that parallel work uses: by default, every core that this process may run on. It is
/// OpenMP's number (OMP_NUM_THREADS), which torch shares, but the threads themselves are those of run_team().
[[nodiscard]] int num_threads();

/// Sets the number of threads; 0 means all cores. A negative number breaks the contract.
void set_num_threads(int threads);

/// Calls body(begin, end) in parallel on disjoint ranges that cover [0, count). Each range has at least `min_chunk`
/// items, except for the last. An exception thrown by the body is rethrown here once all threads have stopped.
void parallel_for(size_t count, size_t min_chunk, const std::function<void(size_t begin, size_t end)>& body);

/// Calls body(member) concurrently on this thread, as member 0, and on helper threads, as members 1 to threads - 1.
/// Returns when the call on this thread and all calls that have begun have ended. A helper that gets no core from the
/// system before then is neither called nor waited for, so that a busy machine causes no delay. The members must
/// therefore take their work from a shared counter until none is left. There are at most 255 helpers, and fewer if the
/// system cannot provide as many threads.
///
/// An exception thrown by a member is rethrown here. A call from within a member runs on that member alone. The helpers
/// belong to the calling thread and end with it; after a fork, the child gets helpers of its own. `threads` = 0 breaks
/// the contract.
void run_team(size_t threads, const std::function<void(size_t member)>& body);

}  // namespace e2lf
