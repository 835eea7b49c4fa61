// SPDX-License-Identifier: MIT
#include "e2lf/model/onnx/onnx_layers.h"

#include <algorithm>
#include <map>

#include "e2lf/base/contract.h"
#include "e2lf/base/text.h"

namespace e2lf::model {
namespace {

using Attributes = OnnxGraph::Attributes;
using Integers = std::vector<int64_t>;

/// Adds one layer after another. The steps of a layer are named with separate prefixes, so that no names collide.
class LayerWriter {
 public:
  LayerWriter(OnnxGraph& graph, const Network& network, const std::string& input) : graph_(graph) {
    tensors_["input"] = {input, network.input_channels};
  }

  std::string add(const Layer& layer, size_t channels) {
    std::vector<std::string> inputs;
    for (const std::string& name : layer.inputs) inputs.push_back(tensors_.at(name).name);
    const bool adds = !layer.residual.empty();
    std::string result = add_operation(layer, inputs, (adds || layer.relu ? "linear/" : "layers/") + layer.name);
    if (adds) {
      const std::string name = (layer.relu ? "sums/" : "layers/") + layer.name;
      result = graph_.add_node("Add", {result, tensors_.at(layer.residual).name}, name);
    }
    if (layer.relu) result = graph_.add_node("Relu", {result}, "layers/" + layer.name);
    tensors_[layer.name] = {result, channels};
    return result;
  }

 private:
  struct Tensor {
    std::string name;
    size_t channels = 0;
  };

  std::string add_operation(const Layer& layer, std::vector<std::string> inputs, const std::string& output) {
    const auto stride = static_cast<int64_t>(layer.stride);
    switch (layer.op) {
      case Op::kConv:
      case Op::kConvTransposed:
        return add_convolution(layer, inputs.front(), output);
      case Op::kPixelUnshuffle:
        return add_unshuffle(layer, inputs.front(), output);
      case Op::kPixelShuffle:
        return graph_.add_node("DepthToSpace", inputs, output, {{"blocksize", stride}, {"mode", std::string("CRD")}});
      case Op::kUpsample:
        return add_resize(layer, inputs.front(), output,
                          {{"mode", std::string("nearest")},
                           {"coordinate_transformation_mode", std::string("asymmetric")},
                           {"nearest_mode", std::string("floor")}});
      case Op::kUpsampleBilinear:
        return add_resize(
            layer, inputs.front(), output,
            {{"mode", std::string("linear")}, {"coordinate_transformation_mode", std::string("half_pixel")}});
      case Op::kAdd:
        return graph_.add_node("Sum", inputs, output);
      case Op::kMean:
        return graph_.add_node("Mean", inputs, output);
      case Op::kConcat:
        return graph_.add_node("Concat", inputs, output, {{"axis", int64_t{1}}});
      case Op::kSigmoid:
        return graph_.add_node("Sigmoid", inputs, output);
      case Op::kTanh:
        return graph_.add_node("Tanh", inputs, output);
      case Op::kConvGru:
      case Op::kConvLstm:
      case Op::kPrevious:
      case Op::kDynamicFilter:
      case Op::kLayerNorm:
      case Op::kPositionCode:
      case Op::kAttention:
        break;
    }
    E2LF_REQUIRE(false, "onnx_refusal() names such layers");
    return {};
  }

  std::string add_convolution(const Layer& layer, const std::string& input, const std::string& output) {
    const auto kernel = static_cast<int64_t>(layer.kernel), stride = static_cast<int64_t>(layer.stride);
    Attributes attributes = {{"kernel_shape", Integers{kernel, kernel}}, {"strides", Integers{stride, stride}}};
    const std::vector<std::string> operands = {input, "weights/" + layer.name + ".weight",
                                               "weights/" + layer.name + ".bias"};
    if (layer.op == Op::kConvTransposed) return graph_.add_node("ConvTranspose", operands, output, attributes);
    const int64_t radius = kernel == stride ? 0 : kernel / 2;
    attributes.emplace_back("pads", Integers(4, radius));
    return graph_.add_node("Conv", operands, output, attributes);
  }

  /// ONNX orders the result with pixels of a block before channels, whereas Op::kPixelUnshuffle has channels first.
  std::string add_unshuffle(const Layer& layer, const std::string& input, const std::string& output) {
    const size_t channels = tensors_.at(layer.inputs.front()).channels, area = layer.stride * layer.stride;
    Integers order;
    for (size_t c = 0; c < channels; ++c) {
      for (size_t pixel = 0; pixel < area; ++pixel) order.push_back(static_cast<int64_t>(pixel * channels + c));
    }
    const std::string blocks = graph_.add_node("SpaceToDepth", {input}, "blocks/" + layer.name,
                                               {{"blocksize", static_cast<int64_t>(layer.stride)}});
    const std::string indices = graph_.add_constant("orders/" + layer.name, order);
    return graph_.add_node("Gather", {blocks, indices}, output, {{"axis", int64_t{1}}});
  }

  std::string add_resize(const Layer& layer, const std::string& input, const std::string& output,
                         const Attributes& attributes) {
    const auto stride = static_cast<float>(layer.stride);
    const std::vector<float> scales = {1.0F, 1.0F, stride, stride};
    const size_t size = scales.size();
    const std::string name = graph_.add_constant("scales/" + layer.name, std::span(&size, 1), scales);
    return graph_.add_node("Resize", {input, "", name}, output, attributes);
  }

  OnnxGraph& graph_;
  std::map<std::string, Tensor> tensors_;
};

}  // namespace

std::string onnx_refusal(const Network& network) {
  for (const Layer& layer : network.layers) {
    if (is_cell(layer) || layer.op == Op::kPrevious) {
      return cat("layer \"", layer.name, "\" remembers the frame before");
    }
    if (layer.op == Op::kDynamicFilter) return cat("layer \"", layer.name, "\" filters each pixel in its own way");
    if (layer.op == Op::kLayerNorm) return cat("layer \"", layer.name, "\" normalises each pixel over its channels");
    if (needs_whole_image(layer)) return cat("layer \"", layer.name, "\" needs the whole image");
  }
  return "";
}

std::string add_onnx_layers(OnnxGraph& graph, const Network& network, const Weights& weights,
                            const std::string& input) {
  for (const WeightShape& tensor : weight_shapes(network)) {
    graph.add_constant("weights/" + tensor.name, tensor.shape, weights.at(tensor.name));
  }
  const std::vector<LayerShape> shapes = infer_shapes(network).value();
  LayerWriter writer(graph, network, input);
  std::string output;
  for (size_t i = 0; i < network.layers.size(); ++i) output = writer.add(network.layers[i], shapes[i].channels);
  return output;
}

}  // namespace e2lf::model
