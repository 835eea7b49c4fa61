// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "e2lf/engine/kernel.h"
#include "e2lf/engine/row_memory.h"

namespace e2lf::engine {
using kernels::assign, kernels::Bfloat16, kernels::kPanelWidth, kernels::to_bfloat16, kernels::to_float;

/// Matrices [depth, columns] in the order in which the multiplication reads them: panel by panel of columns, and row by
/// row within a panel (bfloat16 and int16: by pairs of rows, with the two elements of a column side by side). Columns
/// are padded to kChannelMultiple, and depth to an even number, with zeros. Panels that are as wide as a kernel's sums
/// make it read the weights in the order of memory; the width must be a power of two.
class PackedMatrices {
 public:
  using Element = std::function<float(size_t matrix, size_t row, size_t column)>;

  PackedMatrices() = default;
  PackedMatrices(ElementType type, size_t count, size_t depth, size_t columns, const Element& element,
                 size_t panel_width = kPanelWidth);

  [[nodiscard]] size_t depth() const { return depth_; }      ///< padded
  [[nodiscard]] size_t columns() const { return columns_; }  ///< padded

  /// Returns rows [0, depth) of the panel that begins at `column` (a multiple of the panel width). Its width, and the
  /// number of elements per row, is min(panel width, columns() - column).
  template <typename T>
  [[nodiscard]] const T* panel(size_t matrix, size_t column) const {
    return buffer_.as<T>() + (matrix * columns_ + column) * depth_;
  }

 private:
  size_t depth_ = 0;
  size_t columns_ = 0;
  AlignedBuffer buffer_;
};

/// Weights as integers: column c of the matrices is `units[c]` times the integers.
struct ScaledWeights {
  PackedMatrices weights;
  std::vector<float> units;
};

/// Packs matrices as int16, with units so that sums of products with int16 over the rows of `summed` matrices (1 or
/// all) do not overflow int32.
[[nodiscard]] ScaledWeights pack_int16(size_t count, size_t depth, size_t columns,
                                       const PackedMatrices::Element& element, size_t summed, size_t panel_width);

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
// channels. With `integers`, products are of 16-bit integers, which needs int16_supported(): each tile of inputs and
// each output channel of the weights has a scale of its own, with which sums cannot overflow.
[[nodiscard]] std::string winograd_refusal(const ConvSpec& spec);
[[nodiscard]] std::string winograd_int16_refusal(const ConvSpec& spec);
[[nodiscard]] std::unique_ptr<Kernel> make_winograd(const ConvSpec& spec, bool integers = false);

// Direct sums over the taps on AMX tiles: bfloat16, for any convolution with more than a few channels. make_amx()
// requires that amx_refusal() is "".
[[nodiscard]] std::string amx_refusal(const ConvSpec& spec);
[[nodiscard]] std::unique_ptr<Kernel> make_amx(const ConvSpec& spec);

// Direct sums over the taps of the kernel, for any convolution. With `integers`, the inputs of a few pixels and each
// output channel of the weights have a scale of their own.
[[nodiscard]] std::unique_ptr<Kernel> make_direct(const ConvSpec& spec, bool integers = false);

/// Composes a chain of stride-1 convolutions without anything between them into the single convolution that equals it
/// away from the border: kernel = 1 + sum(kernel_i - 1), with taps and bias computed in double precision. ReLU,
/// residual and types are those of the last convolution.
[[nodiscard]] ConvSpec compose(const std::vector<ConvSpec>& chain);

/// Returns the distance from the image border within which compose() differs from the chain, whose intermediate results
/// are zero outside of the image: the sum of the radii of all but the first convolution, e.g. 4 for three 5x5 kernels.
[[nodiscard]] size_t frame_width(const std::vector<ConvSpec>& chain);

/// Returns true if computing compose(chain) costs less than the chain itself.
[[nodiscard]] bool worth_composing(const std::vector<ConvSpec>& chain);

/// Makes a kernel that computes a chain by its composition and, within the frame at the border, layer by layer. Only
/// the last convolution may have a ReLU, and none may have a residual.
[[nodiscard]] std::unique_ptr<Kernel> make_chain(const std::vector<ConvSpec>& chain);

}  // namespace e2lf::engine
