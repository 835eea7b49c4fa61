// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/options.h"

namespace e2lf::model {

/// The operations of layers. All tensors are [channel, y, x], and "same" zero padding is used throughout.
enum class Op {
  kConv,  ///< kernel x kernel convolution (cross-correlation), with kernel = stride and no padding, or with an odd
          ///< kernel that is centred on input pixel i * stride for output pixel i
  kConvTransposed,    ///< transposed convolution with kernel = stride (no overlap), whose shapes invert those of the
                      ///< strided one
  kPixelUnshuffle,    ///< space to depth by `stride`: out channel = c * stride^2 + dy * stride + dx
  kPixelShuffle,      ///< depth to space by `stride`, the inverse of kPixelUnshuffle
  kUpsample,          ///< nearest neighbour by `stride`
  kUpsampleBilinear,  ///< bilinear by `stride`: output pixel i lies at (i + 1/2) / stride - 1/2; edge pixels are
                      ///< repeated
  kAdd,               ///< sum of all inputs
  kMean,              ///< mean of all inputs
  kConcat,            ///< concatenation of the inputs along the channels
  kSigmoid,           ///< 1 / (1 + exp(-x))
  kTanh,
  kDynamicFilter,  ///< each pixel has its own filters: inputs x [C] and f [M kernel^2] give [M C], where out[m C +
                   ///< c](y, x) = sum over dy, dx of f[(m kernel + dy) kernel + dx](y, x) x[c](y + dy - r, x + dx - r),
                   ///< r = kernel / 2 (odd kernel)
  kLayerNorm,      ///< normalises each pixel over its channels: (x - mean) / sqrt(variance + 1e-5) * weight + bias
  kPositionCode,   ///< adds a code of the position of the pixel: for pixel n = y width + x, channel 2 i gets sin(n /
                   ///< 10000^(2 i / C)), and channel 2 i + 1 the cosine
  kAttention,  ///< multi-head attention between all pixels: inputs q, k, v [C], whose channels are `heads` equal parts;
               ///< each part of pixel i is the sum over pixels j of softmax_j(q_i . k_j / sqrt(C / heads)) v_j
  kPrevious,   ///< output of the last layer for the previous frame, initially zero; no inputs, out_channels as in that
               ///< layer

  // Cells with a memory of the previous frame, which is initially zero. * is the "same" convolution with `kernel`
  // (odd), and [a, b] is kConcat. The input is x and the result h.
  kConvGru,   ///< (u, r) = sigmoid(gates * [x, h']), h = (1 - u) h' + u tanh(candidate * [x, r h']); h' is the previous
              ///< h
  kConvLstm,  ///< (i, f, o) = sigmoid and g = tanh of the parts of gates * [x, h']; c = f c' + i g, h = o tanh(c)
};

/// One layer, whose output is identified by its name. Its weights are "<name>.weight" [out, in, kernel, kernel] (for
/// kConvTransposed [in, out, kernel, kernel], as in torch) and "<name>.bias" [out]; for kLayerNorm, both are
/// [channels]. Cells have such weights for two convolutions: "<name>.gates" (kConvGru: 2 out = u, r; kConvLstm: 4 out =
/// i, f, o, g) and, for kConvGru only, "<name>.candidate" (out).
struct Layer {
  std::string name;
  Op op = Op::kConv;
  std::vector<std::string> inputs;  ///< names of earlier layers, or "input"
  size_t out_channels = 0;          ///< kConv, kConvTransposed, kPrevious, cells
  size_t kernel = 1;                ///< kConv, kConvTransposed, kDynamicFilter, cells
  size_t stride = 1;
  size_t heads = 1;      ///< kAttention
  std::string residual;  ///< kConv: a tensor of the shape of the output, added before the activation; "" = none
  bool relu = false;     ///< applies ReLU at the end, for the operations up to kSigmoid

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
/// kernels of 127 and scales of 1024) and kShape (channels or scales that do not fit together). The location is the
/// layer. The functions below require a network that passes.
[[nodiscard]] Result<std::vector<LayerShape>> infer_shapes(const Network& network);

/// Returns the smallest number of which the height and width of an input must be multiples (1 for networks at full
/// resolution). Reconstruction pads images accordingly.
[[nodiscard]] size_t size_multiple(const Network& network);

/// Returns true for kConvGru and kConvLstm.
[[nodiscard]] bool is_cell(const Layer& layer);

/// Returns true if the output of a layer depends on all pixels of an image (kAttention) or on their positions in it
/// (kPositionCode).
[[nodiscard]] bool needs_whole_image(const Layer& layer);

/// Returns true if a network remembers the previous frame, i.e. has cells or kPrevious.
[[nodiscard]] bool is_recurrent(const Network& network);

/// The name ("<layer>.weight" or "<layer>.bias") and the shape of a tensor of weights, as documented at Layer.
struct WeightShape {
  std::string name;
  std::vector<size_t> shape;
};

/// Lists all tensors that the layers of the network need, in order.
[[nodiscard]] std::vector<WeightShape> weight_shapes(const Network& network);

/// Returns the number of multiply-adds per input pixel, without those of kAttention, which grow with the image (2 C for
/// each pair of pixels); and the number of weights and biases.
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

/// Returns the paper's RecNet for N - 1 event images and 64 views: three linear 5x5 convolutions, 19 3x3 convolutions
/// with ReLU and a linear one, with the output of the third layer added to the last (layers conv1..conv3, l1..l20).
[[nodiscard]] Network recnet(size_t input_channels, size_t output_channels = 64, size_t width = 64);

}  // namespace e2lf::model
