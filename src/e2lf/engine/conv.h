// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "e2lf/engine/kernel.h"

namespace e2lf::engine {

/// One convolution with the operations fused to it: output = relu(conv(input) + bias + residual).
struct ConvSpec {
  size_t in_channels = 0;
  size_t out_channels = 0;
  size_t kernel = 1;
  size_t stride = 1;          ///< equal to the kernel size (no padding), or less for an odd kernel
  bool transposed = false;    ///< requires stride = kernel; upsampling, the inverse of a strided convolution in shape
  std::vector<float> weight;  ///< [out, in, kernel, kernel], also if transposed
  std::vector<float> bias;    ///< [out]
  bool relu = false;
  bool residual = false;
  ElementType compute = ElementType::kFloat32;  ///< type of the input, the weights and the residual
  ElementType output = ElementType::kFloat32;
  bool int16_products = false;  ///< products may be of integers; needs int16_supported() and compute = kFloat32

  [[nodiscard]] float tap(size_t out, size_t in, size_t dy, size_t dx) const {
    return weight[((out * in_channels + in) * kernel + dy) * kernel + dx];
  }
};

/// Makes the fastest kernel that can compute `spec`. Using bfloat16 without bfloat16_supported() breaks the contract.
[[nodiscard]] std::unique_ptr<Kernel> make_conv(const ConvSpec& spec);

/// Returns the number of products per output pixel, transforms included, of the cheaper of Winograd and direct sums.
/// Weights are not needed. AMX, which make_conv() may choose, is not considered.
[[nodiscard]] double conv_cost(const ConvSpec& spec);

/// Returns true if the CPU multiplies bfloat16 pairs (AVX512_BF16), the build supports it and E2LF_MAX_ISA allows it.
[[nodiscard]] bool bfloat16_supported();

/// Returns true if the CPU multiplies pairs of 16-bit integers faster than float32 (AVX2, or AVX-512 with VNNI) and
/// E2LF_MAX_ISA allows it.
[[nodiscard]] bool int16_supported();

/// One method of computing convolutions. `refusal` returns why it cannot or should not compute a spec, or "" if it can.
/// Using bfloat16 without bfloat16_supported() breaks the contract of `make`.
struct ConvMethod {
  std::string name;
  std::string (*refusal)(const ConvSpec& spec);
  std::unique_ptr<Kernel> (*make)(const ConvSpec& spec);
};

/// Returns all methods, fastest first.
[[nodiscard]] const std::vector<ConvMethod>& conv_methods();

// The methods. Winograd F(4x4, 3x3) is for stride 1: each 4x4 tile of outputs takes 36 products per channel pair
// instead of 144. Kernels larger than 3x3 are split into 3x3 parts, which see shifted copies of the input as additional
// channels.
[[nodiscard]] std::string winograd_refusal(const ConvSpec& spec);
[[nodiscard]] std::unique_ptr<Kernel> make_winograd(const ConvSpec& spec);

// The same with products of 16-bit integers. Each tile of inputs and each output channel of the weights has a scale of
// its own, with which sums cannot overflow.
[[nodiscard]] std::string winograd_int16_refusal(const ConvSpec& spec);
[[nodiscard]] std::unique_ptr<Kernel> make_winograd_int16(const ConvSpec& spec);

// Direct sums over the taps on AMX tiles: bfloat16, for any convolution with more than a few channels. make_amx()
// requires that amx_refusal() is "".
[[nodiscard]] std::string amx_refusal(const ConvSpec& spec);
[[nodiscard]] std::unique_ptr<Kernel> make_amx(const ConvSpec& spec);

// Direct sums over the taps of the kernel, for any convolution.
[[nodiscard]] std::unique_ptr<Kernel> make_direct(const ConvSpec& spec);

// The same with products of 16-bit integers. The inputs of a few pixels and each output channel of the weights have a
// scale of their own.
[[nodiscard]] std::unique_ptr<Kernel> make_direct_int16(const ConvSpec& spec);

}  // namespace e2lf::engine
