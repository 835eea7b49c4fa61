// SPDX-License-Identifier: MIT
#pragma once

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

enum E2lfTorchOp {
  kE2lfConv,
  kE2lfGru,
  kE2lfLstm,
  kE2lfBilinear,
  kE2lfAdd,
  kE2lfMean,
  kE2lfSigmoid,
  kE2lfLayerNorm,
  kE2lfPositionCode,
  kE2lfAttention
};

/// A layer of a network that makes frames of voxel grids. Tensor 0 is the input, tensor i + 1 the result of layer i.
struct E2lfTorchVideoLayer {
  enum E2lfTorchOp op;
  const size_t* inputs;  ///< tensors
  size_t num_inputs;
  size_t residual;  ///< tensor + 1; 0 = none
  size_t out_channels, in_channels, kernel, stride, heads;
  int relu;
  const float *weight, *bias;                      ///< [out, in, kernel, kernel], [out]; of cells the gates;
                                                   ///< of kE2lfLayerNorm both [in]
  const float *candidate_weight, *candidate_bias;  ///< kE2lfGru
};

/// Frames through such a network, for libtorch; what cells remember goes from frame to frame.
struct E2lfTorchVideoJob {
  size_t num_layers;
  const struct E2lfTorchVideoLayer* layers;
  size_t in_channels, height, width, frames;
  const float* input;  ///< [in_channels, height, width], the same for each frame
  float* output;       ///< [height, width] of the last frame
  int threads;
  double* seconds;  ///< one for each frame
};

/// Runs the job in float32; null, or what went wrong (valid until the next call).
const char* e2lf_torch_event_video(const struct E2lfTorchVideoJob* job);

#ifdef __cplusplus
}
#endif
