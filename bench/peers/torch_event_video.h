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

/// A layer of a network that makes frames from voxel grids. Tensor 0 is the input, and tensor i + 1 is the result of
/// layer i.
struct E2lfTorchVideoLayer {
  enum E2lfTorchOp op;
  const size_t* inputs;  ///< numbers of tensors
  size_t num_inputs;
  size_t residual;  ///< number of the tensor + 1; 0 = none
  size_t out_channels, in_channels, kernel, stride, heads;
  int relu;
  const float *weight, *bias;                      ///< [out, in, kernel, kernel] and [out]; of a cell, its gates;
                                                   ///< of kE2lfLayerNorm, both [in]
  const float *candidate_weight, *candidate_bias;  ///< kE2lfGru
};

/// Frames to compute with such a network in libtorch. The states of cells are carried from frame to frame.
struct E2lfTorchVideoJob {
  size_t num_layers;
  const struct E2lfTorchVideoLayer* layers;
  size_t in_channels, height, width, frames;
  const float* input;  ///< [in_channels, height, width], the same for each frame
  float* output;       ///< [height, width] of the last frame
  int threads;
  double* seconds;  ///< one per frame
};

/// Runs the job in float32. Returns null, or an error message that is valid until the next call.
const char* e2lf_torch_event_video(const struct E2lfTorchVideoJob* job);

#ifdef __cplusplus
}
#endif
