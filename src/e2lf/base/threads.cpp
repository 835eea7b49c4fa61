// SPDX-License-Identifier: MIT
#include "e2lf/base/threads.h"

#include <algorithm>
#include <atomic>
#ifdef _OPENMP
#include <omp.h>
#endif

#include "e2lf/base/contract.h"
#include "e2lf/base/team.h"

namespace e2lf {

int num_threads() {
#ifdef _OPENMP
  return omp_get_max_threads();
#else
  return 1;  // the fuzzing build has no OpenMP
#endif
}

void set_num_threads(int threads) {
  E2LF_REQUIRE(threads >= 0, "the number of threads cannot be negative");
#ifdef _OPENMP
  omp_set_num_threads(threads == 0 ? omp_get_num_procs() : threads);
#endif
}

void parallel_for(size_t count, size_t min_chunk, const std::function<void(size_t, size_t)>& body) {
  if (count == 0) return;
  min_chunk = std::max<size_t>(min_chunk, 1);
  const size_t threads = std::clamp<size_t>(count / min_chunk, 1, static_cast<size_t>(num_threads()));
  if (threads == 1) return body(0, count);
  // Each thread gets several chunks, so that one slow chunk does not delay the rest.
  const size_t chunk = std::max(min_chunk, (count + threads * 4 - 1) / (threads * 4));
  const size_t chunks = (count + chunk - 1) / chunk;
  std::atomic<size_t> next = 0;
  run_team(threads, [&](size_t /*member*/) {
    for (size_t i = next++; i < chunks; i = next++) body(i * chunk, std::min(count, (i + 1) * chunk));
  });
}

}  // namespace e2lf
