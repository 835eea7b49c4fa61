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

/// A layer of a network. Tensor 0 is the input, and tensor i + 1 is the result of layer i.
struct E2lfTorchLayer {
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

/// Images to compute with such a network in libtorch. The states of cells are carried from image to image.
struct E2lfTorchNetworkJob {
  size_t num_layers;
  const struct E2lfTorchLayer* layers;
  size_t in_channels, height, width, runs;
  const float* input;  ///< [in_channels, height, width], the same for each run
  float* output;       ///< [out_channels, height, width] of the last run
  int threads;
  double* seconds;  ///< one per run
};

/// Runs the job in float32. Returns null, or an error message that is valid until the next call.
const char* e2lf_torch_network(const struct E2lfTorchNetworkJob* job);

/// Returns the version, e.g. "1.13.1".
const char* e2lf_torch_version(void);

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
