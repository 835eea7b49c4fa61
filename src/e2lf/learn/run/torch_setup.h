// SPDX-License-Identifier: MIT
#pragma once

#include <c10/core/Device.h>
#include <c10/util/Exception.h>
#include <filesystem>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"

namespace e2lf::learn {

/// Prepares the process for work with torch: applies E2LF_MAX_ISA, uses all cores unless OMP_NUM_THREADS is set, and
/// flushes denormal numbers to zero. Fails as apply_isa_cap() does.
[[nodiscard]] Result<void> prepare_process();

/// Runs `work`, which calls torch, and converts exceptions of torch to errors with this location.
template <typename Work>
auto guarded(const std::filesystem::path& location, Work&& work) -> decltype(work()) {
  try {
    E2LF_RETURN_IF_ERROR(prepare_process());
    return work();
  } catch (const c10::Error& error) {
    return fail(ErrorCode::kInternal, location, "torch failed: ", error.what_without_backtrace(), "; report this");
  }
}

/// Opens the device with this name: "cpu", "cuda" or "cuda:1". Fails with kInvalidValue (another name) and
/// kMissingDependency (this build of torch, or this machine, has no CUDA device with that number).
[[nodiscard]] Result<c10::Device> open_device(const std::string& name);

}  // namespace e2lf::learn
