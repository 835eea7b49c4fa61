// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/guarded.h"

#include <ATen/Context.h>
#include <ATen/Parallel.h>
#include <algorithm>
#include <cstdlib>
#include <thread>

#include "e2lf/base/isa.h"

namespace e2lf::learn {
namespace {

/// Torch may estimate a single core on a virtual machine that has more.
void use_all_cores() {
  if (std::getenv("OMP_NUM_THREADS") == nullptr) {
    at::set_num_threads(std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  }
}

/// The momenta of units that are always zero decay to denormal numbers, with which CPUs are many times slower: a run
/// had lost half of its speed after two thousand steps. Threads inherit this setting from the thread that starts them.
void take_denormals_as_zero() {
  at::globalContext().setFlushDenormal(true);
}

}  // namespace

Result<void> prepare_process() {
#ifdef E2LF_LEARN_KERNELS
  E2LF_RETURN_IF_ERROR(apply_isa_cap());
#endif
  use_all_cores();
  take_denormals_as_zero();
  return {};
}

}  // namespace e2lf::learn
