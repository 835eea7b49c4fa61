// SPDX-License-Identifier: MIT
#pragma once

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Training of the paper's two networks in float32, written with the modules of libtorch.
struct E2lfTorchTraining {
  size_t batch, patch;  ///< of random light fields, 64 views
  size_t steps;
  double* seconds;  ///< one per step
};

/// Runs the steps. Returns null, or an error message that is valid until the next call.
const char* e2lf_torch_training(const struct E2lfTorchTraining* job);

#ifdef __cplusplus
}
#endif
