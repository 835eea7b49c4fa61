// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>

namespace e2lf {

/// The number of threads parallel work uses: every core this process may run on, unless set. It is
/// OpenMP's number (OMP_NUM_THREADS), which torch shares; the threads are those of run_team().
[[nodiscard]] int num_threads();

/// Sets the number; 0 = all cores. Negative breaks the contract.
void set_num_threads(int threads);

/// Calls body(begin, end) on disjoint ranges that cover [0, count), each of at least `min_chunk` items (but the last),
/// in parallel. An exception from the body is rethrown here once all threads have stopped.
void parallel_for(size_t count, size_t min_chunk, const std::function<void(size_t begin, size_t end)>& body);

}  // namespace e2lf
