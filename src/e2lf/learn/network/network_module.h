// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <torch/torch.h>
#include <torch/types.h>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/model/model.h"
#include "e2lf/model/network.h"

namespace e2lf::learn {

/// Named float32 tensors in a fixed order, which are optimised, averaged and saved in checkpoints.
using NamedTensors = std::map<std::string, torch::Tensor>;

/// A network that runs its description as differentiable torch operations, with the same layers, names and weight
/// layouts as in `engine`.
class NetworkModule {
 public:
  /// Shapes of tensors of weights, by name.
  using Shapes = std::map<std::string, std::vector<size_t>>;

  /// Initialises the weights from torch's generator with He's normal distribution, and the biases with zero.
  /// Convolutions with a residual input start at zero, so that every residual block starts as the identity. The
  /// description must be valid, and its operations known to find_operation() of operations.h. The weights
  /// in `others` have other shapes than the layers state, for layers whose output is given.
  NetworkModule(model::Network network, torch::Device device, const Shapes& others = {});

  /// Applies the network to `input`, float32 [batch, input_channels, y, x], where y and x are multiples of
  /// model::size_multiple(). Returns float32 [batch, output_channels, y, x]. Convolutions are computed in the type
  /// `compute` (kFloat or kBFloat16) and channels-last. The master weights are float32 and converted on the fly, so
  /// that the gradients are float32. `weights` are others of the same names and shapes, e.g. their moving average;
  /// null = parameters(). If `input_means` is not null, it receives the mean [in] over pixels and batch of the input of
  /// each convolution that is not transposed, by layer name. Layers in `given` are not computed, but have
  /// these outputs.
  [[nodiscard]] torch::Tensor forward(const torch::Tensor& input, torch::ScalarType compute,
                                      const NamedTensors* weights = nullptr, NamedTensors* input_means = nullptr,
                                      const NamedTensors& given = {}) const;

  /// Returns the parameters "<layer>.weight" and "<layer>.bias": leaves that require gradients.
  [[nodiscard]] const NamedTensors& parameters() const { return parameters_; }
  [[nodiscard]] const model::Network& network() const { return network_; }

 private:
  model::Network network_;
  NamedTensors parameters_;
};

/// The origin of an input channel of one network in another network: the corresponding channel, if any, and the factor
/// by which its weights are multiplied.
struct InputOrigin {
  std::optional<size_t> channel = std::nullopt;
  float factor = 1.0F;
};

/// Adapts the weights of a network to a network that differs only in its input channels. In the layers that read the
/// input, or its unshuffled pixels, each channel receives the weights of its origin, or zeros if it has none. If the
/// layers differ otherwise, the weights are returned unchanged.
[[nodiscard]] model::Weights widen_inputs(const model::Network& network, model::Weights weights,
                                          const model::Network& wider, const std::vector<InputOrigin>& origins);

/// Copies values to tensors of the same names. Fails with kNotFound and kShape, naming the tensor in `location`.
[[nodiscard]] Result<void> load_weights(const NamedTensors& parameters, const model::Weights& weights,
                                        const std::string& location);

/// Copies the values to plain vectors, as a model file contains them.
[[nodiscard]] model::Weights to_weights(const NamedTensors& parameters);

/// Computes a convolution or transposed convolution layer including bias, residual (none if undefined) and ReLU, with
/// the fastest method for the device and type of `input` [b, c, y, x]. The result is channels-last.
[[nodiscard]] torch::Tensor convolve(const model::Layer& layer, const torch::Tensor& input, const torch::Tensor& weight,
                                     const torch::Tensor& bias, const torch::Tensor& residual);

/// Computes a 3x3 convolution with stride 1 and zero padding, adds the bias and an optional residual (none if
/// undefined), and applies ReLU if `relu`. Differentiable. Uses Winograd's method (see winograd_conv.h) in float32 on
/// the CPU, on torch's threads. x is [b, in, y, x], weight [out, in, 3, 3], bias [out], residual and result [b, out, y,
/// x]; images are channels-last. A residual together with ReLU is not supported, because the gradient of the residual
/// would need the mask of the ReLU.
[[nodiscard]] torch::Tensor conv3x3(const torch::Tensor& x, const torch::Tensor& weight, const torch::Tensor& bias,
                                    const torch::Tensor& residual, bool relu);

/// Computes the pixel shuffle [b, c * s^2, y, x] -> [b, c, y * s, x * s] and its inverse with a single copy. The
/// results are channels-last.
[[nodiscard]] torch::Tensor shuffle(const torch::Tensor& x, int64_t s);
[[nodiscard]] torch::Tensor unshuffle(const torch::Tensor& x, int64_t s);

/// A layer to be applied to tensors [batch, channel, y, x] in the type of the computation.
struct TorchCall {
  const model::Layer& layer;
  std::vector<torch::Tensor> inputs;

  /// Returns the weights "<layer><part>", e.g. of ".weight", in the same type.
  std::function<torch::Tensor(const std::string& part)> weight;
};

/// Computes the output of a layer, without ReLU.
using TorchOperation = torch::Tensor (*)(const TorchCall& call);

/// Makes an operation that was added to model::Operation known to training. A name that is taken breaks the contract.
void add_operation(const std::string& name, TorchOperation operation);

/// Returns the function of an operation other than convolutions. A name that is unknown breaks the contract.
[[nodiscard]] TorchOperation find_operation(const std::string& name);

/// Returns whether torch has an operation; it has convolutions.
[[nodiscard]] bool has_operation(const std::string& name);

// The operations of e2lf/geometry as differentiable torch operations, which move pictures by slices with the weights of
// at most four neighbours along an axis.

/// Compares pictures at each of K disparities as geometry::GeometryOp::kPlaneSweep does: pictures [batch, P, G, y, x]
/// to [batch, K, y, x]. `offsets` [batch, P, 2] on the CPU are those of each sample, in pixels of the pictures per unit
/// of the disparity; [1, P, 2] if they are the same for all. Computes in the type of the pictures; gradients are those
/// with respect to the pictures.
[[nodiscard]] torch::Tensor sweep_planes(const torch::Tensor& pictures, const torch::Tensor& offsets,
                                         const std::vector<double>& disparities, int64_t window);

/// Layers of geometry::GeometryOp::kPlaneSweep, geometry::GeometryOp::kRenderLayers and geometry::GeometryOp::kWarp.
/// All compute in float32 at least, because evidence is small, opacities are near 1, and places are fractions of a
/// pixel.
[[nodiscard]] torch::Tensor apply_plane_sweep(const TorchCall& call);
[[nodiscard]] torch::Tensor apply_render_layers(const TorchCall& call);
[[nodiscard]] torch::Tensor apply_warp(const TorchCall& call);

}  // namespace e2lf::learn
