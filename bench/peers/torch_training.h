// SPDX-License-Identifier: MIT
#pragma once

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Training of the paper's two networks in float32, as one would write it with libtorch's modules.
struct E2lfTorchTraining {
  size_t batch, patch;  ///< of random light fields, 64 views
  size_t steps;
  double* seconds;  ///< one for each step
};

/// Runs the steps; null, or what went wrong (valid until the next call).
const char* e2lf_torch_training(const struct E2lfTorchTraining* job);

#ifdef __cplusplus
}
#endif
