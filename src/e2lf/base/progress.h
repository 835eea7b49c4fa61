// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>

namespace e2lf {

/// Is called by long operations with the number of parts done and the total, from one thread at a time. An empty
/// function reports nothing.
using ProgressFn = std::function<void(size_t done, size_t total)>;

}  // namespace e2lf
