// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/torch_setup.h"

#include <ATen/Context.h>
#include <ATen/Parallel.h>
#include <algorithm>
#include <cstdlib>
#include <thread>
#include <torch/cuda.h>

#include "e2lf/base/isa.h"

namespace e2lf::learn {

Result<void> prepare_process() {
#ifdef E2LF_LEARN_KERNELS
  E2LF_RETURN_IF_ERROR(apply_isa_cap());
#endif
  // Torch may estimate a single core on a virtual machine that has more.
  if (std::getenv("OMP_NUM_THREADS") == nullptr) {
    at::set_num_threads(std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  }
  // The momenta of units that are always zero decay to denormal numbers, with which CPUs are many times slower: a run
  // had lost half of its speed after two thousand steps. Threads inherit this setting from the thread that starts them.
  at::globalContext().setFlushDenormal(true);
  return {};
}

Result<c10::Device> open_device(const std::string& name) {
  const bool is_cuda = name == "cuda" || (name.starts_with("cuda:") && name.size() > 5 && name.size() < 14 &&
                                          name.find_first_not_of("0123456789", 5) == std::string::npos);
  if (name != "cpu" && !is_cuda) {
    return fail(ErrorCode::kInvalidValue, "device", "there is no device \"", name, "\"; use cpu, cuda or cuda:1");
  }
  if (!is_cuda) return c10::Device("cpu");
  const size_t number = name == "cuda" ? 0 : std::stoul(name.substr(5));
  // In torch 2, the count is of a type that prints as a letter.
  const auto devices = static_cast<size_t>(torch::cuda::device_count());
  if (number >= devices) {
    return fail(ErrorCode::kMissingDependency, "device", "torch finds ", devices, " CUDA devices on this machine, not ",
                name, "; use cpu, or install a driver and a torch with CUDA");
  }
  return c10::Device(c10::kCUDA, static_cast<c10::DeviceIndex>(number));
}

}  // namespace e2lf::learn
