// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/options.h"

namespace e2lf::model {

/// The names of the operations that every build has. All tensors are [channel, y, x], and "same" zero padding is used
/// throughout. add_operation() of operation.h adds others.
struct Op {
  /// kernel x kernel convolution (cross-correlation), with kernel = stride and no padding, or with an odd kernel that
  /// is centred on input pixel i * stride for output pixel i.
  static constexpr const char* kConv = "conv";
  /// Transposed convolution with kernel = stride (no overlap), whose shapes invert those of the strided one.
  static constexpr const char* kConvTransposed = "conv-transposed";
  /// Space to depth by `stride`: out channel = c * stride^2 + dy * stride + dx.
  static constexpr const char* kPixelUnshuffle = "pixel-unshuffle";
  static constexpr const char* kPixelShuffle = "pixel-shuffle";  ///< the inverse of kPixelUnshuffle
  static constexpr const char* kUpsample = "upsample";           ///< nearest neighbour by `stride`
  static constexpr const char* kAdd = "add";                     ///< sum of all inputs
  static constexpr const char* kMean = "mean";                   ///< mean of all inputs
  static constexpr const char* kConcat = "concat";               ///< concatenation of the inputs along the channels
  static constexpr const char* kSigmoid = "sigmoid";             ///< 1 / (1 + exp(-x))
};

/// One layer, whose output is identified by its name. The weights of convolutions are "<name>.weight" [out, in, kernel,
/// kernel] (for kConvTransposed [in, out, kernel, kernel], as in torch) and "<name>.bias" [out]; operation.h describes
/// those of other operations.
struct Layer {
  std::string name;
  std::string op = Op::kConv;
  std::vector<std::string> inputs;  ///< names of earlier layers, or "input"
  size_t out_channels = 0;          ///< of operations whose number of channels does not follow from their inputs
  size_t kernel = 1;
  size_t stride = 1;
  std::map<std::string, std::vector<double>> attributes = {};  ///< further properties by name: one number or a list
  std::string residual = {};  ///< kConv: a tensor of the shape of the output, added before the activation; "" = none
  bool relu = false;          ///< applies ReLU at the end

  /// Returns an attribute that is a whole number: `otherwise` if it is absent, 0 if it is another value.
  [[nodiscard]] size_t integer(const std::string& attribute, size_t otherwise) const;

  bool operator==(const Layer&) const = default;
};

/// A convolutional network as a list of layers in evaluation order, the last of which is the output. The same
/// description serves training and inference.
struct Network {
  size_t input_channels = 0;
  std::vector<Layer> layers;

  bool operator==(const Network&) const = default;
};

/// The shape of the output of a layer relative to the input image: its channels, and the number of input pixels per
/// output pixel along an axis.
struct LayerShape {
  size_t channels = 0;
  size_t scale = 1;
};

/// Computes the shapes of the outputs of all layers, in order. Fails with kInvalidValue (a duplicate or unknown name,
/// an even kernel that differs from the stride, a stride larger than the kernel, or sizes beyond 65536 channels,
/// kernels of 127 and scales of 1024), kShape (channels or scales that do not fit together) and kUnsupported (an
/// unknown operation). The location is the layer. The functions below require a network that passes.
[[nodiscard]] Result<std::vector<LayerShape>> infer_shapes(const Network& network);

/// Returns the smallest number of which the height and width of an input must be multiples (1 for networks at full
/// resolution). Reconstruction pads images accordingly.
[[nodiscard]] size_t size_multiple(const Network& network);

/// Returns true if a network remembers the previous frame.
[[nodiscard]] bool is_recurrent(const Network& network);

/// The name ("<layer>.weight" or "<layer>.bias") and the shape of a tensor of weights, as documented at Layer.
struct WeightShape {
  std::string name;
  std::vector<size_t> shape;
  size_t layer = 0;  ///< number of the layer

  [[nodiscard]] size_t size() const;  ///< number of elements
};

/// Lists all tensors that the layers of the network need, in order.
[[nodiscard]] std::vector<WeightShape> weight_shapes(const Network& network);

/// The values of these tensors by name.
using Weights = std::map<std::string, std::vector<float>>;

/// Returns the number of multiply-adds per input pixel, without those of operations whose cost per pixel grows with the
/// image; and the number of weights and biases.
[[nodiscard]] double macs_per_pixel(const Network& network);
[[nodiscard]] size_t num_parameters(const Network& network);

/// The value of receptive_radius() for networks with a layer that needs the whole image.
inline constexpr size_t kWholeImage = ~size_t{0};

/// Returns the largest number of rows (and columns) of context on each side that one output pixel depends on, within
/// the same frame: 26 for the network of the paper.
[[nodiscard]] size_t receptive_radius(const Network& network);

/// Returns {"type": "conv-graph", "input_channels": 3, "layers": [{"name": "conv1", "op": "conv", "inputs": ["input"],
/// "out_channels": 64, "kernel": 5, ...}, ...]}. Fields with default values are omitted.
[[nodiscard]] Json to_json(const Network& network);

/// Parses the JSON of to_json(). Fails with kUnsupported (another type or operation; the message lists the known ones),
/// kFormat, kInvalidValue (an unknown key) and as infer_shapes() does. The location is `location` and the JSON path or
/// layer.
[[nodiscard]] Result<Network> network_from_json(const Json& json, const std::string& location);

/// Returns the figures of a network, which the summaries of all kinds of models contain: layers, parameters,
/// multiply-adds per pixel and receptive field in pixels.
[[nodiscard]] Json network_summary(const Network& network);

/// Returns the paper's RecNet for N - 1 event images and 64 views: three linear 5x5 convolutions, 19 3x3 convolutions
/// with ReLU and a linear one, with the output of the third layer added to the last (layers conv1..conv3, l1..l20).
[[nodiscard]] Network recnet(size_t input_channels, size_t output_channels = 64, size_t width = 64);

/// The sizes of a residual U-Net. `widths` and `blocks` have one entry per level, the first at half resolution.
struct UnetOptions {
  size_t input_channels = 9;
  size_t output_channels = 64;
  std::vector<size_t> widths = {80, 96, 128};
  std::vector<size_t> blocks = {2, 2, 2};  ///< residual blocks on each side; the last level has only one side
  /// Channels at full resolution before the last 3x3 convolution. If it is 0, the output follows directly from half
  /// resolution by a transposed 2x2 convolution, and `head_blocks` has no effect.
  size_t head_width = 32;
  size_t head_blocks = 0;  ///< residual blocks at full resolution
};

/// Builds a residual U-Net behind a pixel unshuffle by 2, with strided 2x2 convolutions down, transposed 2x2 ones up,
/// and additive skip connections. The head shuffles back to full resolution and ends in a 3x3 convolution, which
/// removes the grid pattern of the shuffle; a 1x1 skip connection from the inputs is added to its output. If
/// `head_blocks` is not 0, a 3x3 convolution of the inputs is added after the shuffle, followed by residual blocks at
/// full resolution, which are free of the grid. Each level halves the resolution, so image sizes must be multiples of
/// 2^levels.
[[nodiscard]] Network unet(const UnetOptions& options);

/// A network and its weights.
struct WeightedNetwork {
  Network network;
  Weights weights;
};

/// Builds input channels [first, first + values.size()), of which each has one value for all pixels, into the weights:
/// in their place, the result has one channel, which must be 1 for all pixels. It is as it was but for rounding, also
/// at the borders, where the padding of that channel is 0. Nothing if layers other than convolutions and pixel
/// unshuffles read the input.
[[nodiscard]] std::optional<WeightedNetwork> with_constant_inputs(const Network& network, const Weights& weights,
                                                                  size_t first, std::span<const float> values);

/// Inserts `count` input channels that the network does not use before channel `first`. Nothing if layers other than
/// convolutions and pixel unshuffles read the input.
[[nodiscard]] std::optional<WeightedNetwork> with_unused_inputs(const Network& network, const Weights& weights,
                                                                size_t first, size_t count);

}  // namespace e2lf::model
