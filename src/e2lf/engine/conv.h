// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "e2lf/engine/kernel.h"

namespace e2lf::engine {

/// One convolution with what is fused behind it: output = relu(conv(input) + bias + residual).
struct ConvSpec {
  size_t in_channels = 0;
  size_t out_channels = 0;
  size_t kernel = 1;
  size_t stride = 1;          ///< the kernel's size (no padding), or less, for an odd kernel
  bool transposed = false;    ///< with stride = kernel: the upsampling inverse of a strided convolution
  std::vector<float> weight;  ///< [out, in, kernel, kernel], for transposed ones too
  std::vector<float> bias;    ///< [out]
  bool relu = false;
  bool residual = false;
  ElementType compute = ElementType::kFloat32;  ///< of the input, the weights and the residual
  ElementType output = ElementType::kFloat32;

  [[nodiscard]] float tap(size_t out, size_t in, size_t dy, size_t dx) const {
    return weight[((out * in_channels + in) * kernel + dy) * kernel + dx];
  }
};

/// Makes the fastest kernel that can compute `spec`. bfloat16 without bfloat16_supported() breaks the contract.
[[nodiscard]] std::unique_ptr<Kernel> make_conv(const ConvSpec& spec);

/// Products per output pixel, transforms included, that the better of Winograd and direct sums takes; needs no weights.
/// AMX, which make_conv() may choose, is not considered.
[[nodiscard]] double conv_cost(const ConvSpec& spec);

/// Whether the CPU multiplies bfloat16 pairs (AVX512_BF16), the build knows how and E2LF_MAX_ISA allows it.
[[nodiscard]] bool bfloat16_supported();

/// One way to compute convolutions. `refusal` says why it cannot or should not compute a spec; "" = it can. bfloat16
/// without bfloat16_supported() breaks the contract of `make`.
struct ConvMethod {
  std::string name;
  std::string (*refusal)(const ConvSpec& spec);
  std::unique_ptr<Kernel> (*make)(const ConvSpec& spec);
};

/// All methods, fastest first.
[[nodiscard]] const std::vector<ConvMethod>& conv_methods();

// The methods. Winograd F(4x4, 3x3) for stride 1: each 4x4 tile of outputs takes 36 products per channel pair instead
// of 144; kernels over 3x3 are split into 3x3 parts that see shifted copies of the input as more channels.
[[nodiscard]] std::string winograd_refusal(const ConvSpec& spec);
[[nodiscard]] std::unique_ptr<Kernel> make_winograd(const ConvSpec& spec);

// Plain sums over the taps on AMX's tiles: bfloat16, any convolution of more than a few channels. make_amx() needs
// that amx_refusal() has nothing against it.
[[nodiscard]] std::string amx_refusal(const ConvSpec& spec);
[[nodiscard]] std::unique_ptr<Kernel> make_amx(const ConvSpec& spec);

/// Rounds of products in AMX's tiles alone, for their peak: the operations done (a multiply-add is two).
double multiply_add_in_tiles(size_t rounds);

// Plain sums over the kernel's taps: any convolution.
[[nodiscard]] std::unique_ptr<Kernel> make_direct(const ConvSpec& spec);

}  // namespace e2lf::engine
