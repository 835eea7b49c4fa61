// SPDX-License-Identifier: MIT
#pragma once

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/// The paper's network and an image, for libtorch. Layers are in order: conv1..conv3 (linear), l1..l19 (ReLU), l20, to
/// which conv3's result is added; all are stride 1 with zero padding.
struct E2lfTorchJob {
  size_t num_layers;
  const size_t* out_channels;
  const size_t* kernels;
  const float* const* weights;  ///< [out, in, kernel, kernel] each
  const float* const* biases;   ///< [out] each
  size_t in_channels, height, width;
  const float* input;  ///< [in_channels, height, width]
  float* output;       ///< [64, height, width], of the last run
  int threads;
  size_t runs;
  double* seconds;  ///< one for each run
};

/// Runs the job in float32; null, or what went wrong (valid until the next call).
const char* e2lf_torch_recnet(const struct E2lfTorchJob* job);

/// "1.13.1" and the like.
const char* e2lf_torch_version(void);

#ifdef __cplusplus
}
#endif
