// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>
#include <vector>

#include "e2lf/model/network.h"

namespace e2lf::model {

struct OnnxCall;  // onnx/onnx_export.h

// These bounds keep all products of sizes far from overflow, because files from other sources are checked.
inline constexpr size_t kMaxChannels = size_t{1} << 16;
inline constexpr size_t kMaxKernel = 127;
inline constexpr size_t kMaxScale = 1024;
inline constexpr size_t kAnyInputs = ~size_t{0};

/// An operation of layers, as model files and the figures of a network need it. engine::Operation adds how it is
/// computed. `inputs` are the shapes of the layer's inputs, in order; functions other than `shape` require that it
/// succeeded.
struct Operation {
  std::string name;  ///< in model files
  size_t min_inputs = 1, max_inputs = 1;
  std::vector<std::string> attributes = {};  ///< names in Layer::attributes that a layer may have
  bool takes_stride_and_relu = false;        ///< if false, layers with a stride or ReLU are refused
  bool remembers = false;                    ///< it depends on the previous frames
  bool is_last_output = false;               ///< it is the output of the last layer for the previous frame

  /// Returns the shape of the output, or an error without a location.
  Result<LayerShape> (*shape)(const Layer& layer, std::span<const LayerShape> inputs) = nullptr;

  /// Returns the weights; null = none.
  std::vector<WeightShape> (*weights)(const Layer& layer, std::span<const LayerShape> inputs) = nullptr;

  /// Returns the multiply-adds per pixel of the output; null = as many as there are weights with four axes.
  double (*macs)(const Layer& layer, std::span<const LayerShape> inputs) = nullptr;

  /// Returns the number of pixels of the inputs, on each side of those at its place, on which an output pixel depends;
  /// null = none. kWholeImage means all pixels, or their positions.
  size_t (*reach)(const Layer& layer) = nullptr;

  /// Adds the operation to an ONNX graph and returns the name of the result; null = it is not exported.
  std::string (*onnx)(OnnxCall& call) = nullptr;
};

/// Makes an operation known to this process, before the first network with it is used. A name that is taken breaks the
/// contract. Networks keep working while other threads add operations.
void add_operation(Operation operation);

/// Returns the operation of that name, or null.
[[nodiscard]] const Operation* find_operation(const std::string& name);

/// Returns the error of a model with an operation that this process does not know: for those of other components of
/// e2lf it states the component and the call that adds them.
[[nodiscard]] Error unknown_operation(const std::string& name, const std::string& location);

// Parts of Operation::shape that several operations share. Their errors have no location.

/// Fails with kInvalidValue unless the kernel is odd, or equals the stride, and is at most kMaxKernel.
[[nodiscard]] Result<void> check_kernel(const Layer& layer);

/// Returns the shape of the first input. Fails with kShape if another input has another shape.
[[nodiscard]] Result<LayerShape> equal_shapes(const Layer& layer, std::span<const LayerShape> inputs);

/// Returns the resolution of the first input times the stride, with `channels` channels. Fails with kShape if the scale
/// is no multiple of the stride.
[[nodiscard]] Result<LayerShape> finer_shape(const Layer& layer, std::span<const LayerShape> inputs, size_t channels);

/// Returns the weight [out, in, kernel, kernel] and the bias [out] of a convolution called `name`.
[[nodiscard]] std::vector<WeightShape> conv_weights(const std::string& name, size_t out, size_t in, size_t kernel);

}  // namespace e2lf::model
