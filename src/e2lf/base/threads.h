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

}  // namespace e2lf
