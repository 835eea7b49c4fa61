// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/options.h"

namespace e2lf::model {

/// What one layer of a network does. All tensors are [channel, y, x]; "same" zero padding throughout.
enum class Op {
  kConv,  ///< kernel x kernel convolution (cross-correlation): kernel = stride (no padding), else an odd kernel whose
          ///< centre for output pixel i is input pixel i * stride
  kConvTransposed,    ///< kernel = stride transposed convolution (no overlap): the inverse of the strided one in shape
  kPixelUnshuffle,    ///< space to depth by `stride`: out channel = c * stride^2 + dy * stride + dx
  kPixelShuffle,      ///< depth to space by `stride`, the inverse of kPixelUnshuffle
  kUpsample,          ///< nearest neighbour by `stride`
  kUpsampleBilinear,  ///< by `stride`: output pixel i lies at (i + 1/2) / stride - 1/2; beyond the edge is the edge
  kAdd,               ///< sum of all inputs
  kMean,              ///< mean of all inputs
  kConcat,            ///< inputs one after another along the channels
  kSigmoid,           ///< 1 / (1 + exp(-x))
  kTanh,
  kDynamicFilter,  ///< each pixel has filters of its own: inputs x [C] and f [M kernel^2] give [M C],
                   ///< out[m C + c](y, x) = sum over dy, dx of f[(m kernel + dy) kernel + dx](y, x) x[c](y + dy - r, x
                   ///< + dx - r), r = kernel / 2 (odd kernel)
  kLayerNorm,      ///< each pixel over its channels: (x - mean) / sqrt(variance + 1e-5) * weight + bias
  kPositionCode,   ///< x + a code of where the pixel is: of pixel n = y width + x, channel 2 i gets sin(n /
                   ///< 10000^(2 i / C)), channel 2 i + 1 the cosine
  kAttention,  ///< each pixel looks at all: inputs q, k, v [C], whose channels are `heads` equal parts; each part of
               ///< pixel i is the sum over pixels j of softmax_j(q_i . k_j / sqrt(C / heads)) v_j
  kPrevious,   ///< what the last layer gave of the frame before, zeros at first; no inputs, out_channels as that layer

  // Cells with a memory of the frame before, which begins at zero; * is "same" convolution with `kernel` (odd), [a, b]
  // is kConcat. The input is x, the result h.
  kConvGru,   ///< (u, r) = sigmoid(gates * [x, h']), h = (1 - u) h' + u tanh(candidate * [x, r h']); h' = the last h
  kConvLstm,  ///< (i, f, o) = sigmoid, g = tanh of the parts of gates * [x, h']; c = f c' + i g, h = o tanh(c)
};

/// One layer; its output is known by its name. Weights: "<name>.weight" [out, in, kernel, kernel] (for kConvTransposed
/// [in, out, kernel, kernel], as in torch) and "<name>.bias" [out]; of kLayerNorm both are [channels]. Cells have the
/// same of two convolutions, "<name>.gates" (kConvGru: 2 out = u, r; kConvLstm: 4 out = i, f, o, g) and, of kConvGru,
/// "<name>.candidate" (out).
struct Layer {
  std::string name;
  Op op = Op::kConv;
  std::vector<std::string> inputs;  ///< earlier layers, or "input"
  size_t out_channels = 0;          ///< kConv, kConvTransposed, kPrevious, cells
  size_t kernel = 1;                ///< kConv, kConvTransposed, kDynamicFilter, cells
  size_t stride = 1;
  size_t heads = 1;      ///< kAttention
  std::string residual;  ///< kConv: a tensor of the output's shape added before the activation; "" = none
  bool relu = false;     ///< ReLU at the end, for the ops up to kSigmoid

  bool operator==(const Layer&) const = default;
};

/// A convolutional network as a list of layers in the order of evaluation; the last one is the output. Described once,
/// for training and inference alike.
struct Network {
  size_t input_channels = 0;
  std::vector<Layer> layers;

  bool operator==(const Network&) const = default;
};

/// Shape of a layer's output relative to the input image: channels, and the number of input pixels per output pixel.
struct LayerShape {
  size_t channels = 0;
  size_t scale = 1;
};

/// The shape of every layer's output, in order. Fails with kInvalidValue (a name used twice or unknown, an even kernel
/// that is not the stride, a stride beyond the kernel, sizes beyond any use: 65536 channels, kernels of 127, scales of
/// 1024) and kShape (channels or scales that do not fit); the location is the layer. The functions below need a network
/// that passes.
[[nodiscard]] Result<std::vector<LayerShape>> infer_shapes(const Network& network);

/// The smallest common factor that the height and width of an input must be a multiple of (1 for plain networks);
/// reconstruction pads to it.
[[nodiscard]] size_t size_multiple(const Network& network);

/// Whether a layer is kConvGru or kConvLstm.
[[nodiscard]] bool is_cell(const Layer& layer);

/// Whether a layer's output depends on all pixels of an image: kAttention; or on where in it they are: kPositionCode.
[[nodiscard]] bool needs_whole_image(const Layer& layer);

/// Whether a network remembers the frame before: whether it has cells or kPrevious.
[[nodiscard]] bool is_recurrent(const Network& network);

/// A tensor of weights: its name ("<layer>.weight", "<layer>.bias") and shape as documented at Layer.
struct WeightShape {
  std::string name;
  std::vector<size_t> shape;
};

/// Every tensor that the network's layers need, in their order.
[[nodiscard]] std::vector<WeightShape> weight_shapes(const Network& network);

/// Multiply-adds per input pixel, without those of kAttention, which grow with the image (2 C for each pair of pixels);
/// and the number of weights and biases.
[[nodiscard]] double macs_per_pixel(const Network& network);
[[nodiscard]] size_t num_parameters(const Network& network);

/// What receptive_radius() is of networks with a layer that needs the whole image.
inline constexpr size_t kWholeImage = ~size_t{0};

/// Rows (and columns) of context on each side that one output pixel sees at most, of the same frame: 26 for the paper's
/// network.
[[nodiscard]] size_t receptive_radius(const Network& network);

/// {"type": "conv-graph", "input_channels": 3, "layers": [{"name": "conv1", "op": "conv", "inputs": ["input"],
/// "out_channels": 64, "kernel": 5, ...}, ...]}; fields at their default are left out.
[[nodiscard]] Json to_json(const Network& network);

/// Fails with kUnsupported (another type or operation; the message names the known ones), kFormat, kInvalidValue (an
/// unknown key) and as infer_shapes() does, with `location` and the JSON path or layer.
[[nodiscard]] Result<Network> network_from_json(const Json& json, const std::string& location);

/// The paper's RecNet for N - 1 event images in and 64 views out: three linear 5x5 convolutions, 19 3x3 ones with ReLU
/// and a linear one, with f3 added to the output (layers conv1..conv3, l1..l20).
[[nodiscard]] Network recnet(size_t input_channels, size_t output_channels = 64, size_t width = 64);

}  // namespace e2lf::model
