// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>

namespace e2lf {

/// Is called by long operations with the number of parts done and the total, from one thread at a time. An empty
/// function reports nothing.
using ProgressFn = std::function<void(size_t done, size_t total)>;

/// Returns the function that reports the progress of one pass as part of several equal passes.
[[nodiscard]] inline ProgressFn progress_of_pass(const ProgressFn& progress, size_t pass, size_t passes) {
  if (!progress) return {};
  return [=](size_t done, size_t total) { progress(pass * total + done, passes * total); };
}

}  // namespace e2lf
