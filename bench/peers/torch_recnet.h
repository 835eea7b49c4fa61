// SPDX-License-Identifier: MIT
#pragma once

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/// The paper's network and an image, for libtorch. The layers are conv1..conv3 (linear), l1..l19 (ReLU) and l20, to
/// which the result of conv3 is added. All have stride 1 with zero padding.
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
  double* seconds;  ///< one per run
};

/// Runs the job in float32. Returns null, or an error message that is valid until the next call.
const char* e2lf_torch_recnet(const struct E2lfTorchJob* job);

/// Returns the version, e.g. "1.13.1".
const char* e2lf_torch_version(void);

#ifdef __cplusplus
}
#endif
