// SPDX-License-Identifier: MIT
#pragma once

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/// The paper's network and an image, for a peer. The layers are conv1..conv3 (linear), l1..l19 (ReLU) and l20, to
/// which the result of conv3 is added. All have stride 1 with zero padding.
struct E2lfRecnetJob {
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

#ifdef __cplusplus
}
#endif
