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

/// Runs the job in oneDNN, with weights, biases and layers in between in float32, or all of them in bfloat16 with sums
/// in float32. A run, of which an untimed one is the first, converts the input and the
/// output, but not the weights.
/// `isa` limits the instruction set, as e2lf::current_isa() names it; the limit of the first call holds for the
/// process. Returns null, or an error message that is valid until the next call.
const char* e2lf_onednn_recnet(const struct E2lfRecnetJob* job, int bfloat16, const char* isa);

/// Returns the version, e.g. "2.6.3".
const char* e2lf_onednn_version(void);

#ifdef __cplusplus
}
#endif
