// SPDX-License-Identifier: MIT
#include "e2lf/model/onnx/onnx_layers.h"

#include <map>

#include "e2lf/base/contract.h"
#include "e2lf/base/text.h"
#include "e2lf/model/operation.h"

namespace e2lf::model {
namespace {

using Integers = std::vector<int64_t>;

std::string add_convolution(OnnxCall& call) {
  const Layer& layer = call.layer;
  const auto kernel = static_cast<int64_t>(layer.kernel), stride = static_cast<int64_t>(layer.stride);
  OnnxGraph::Attributes attributes = {{"kernel_shape", Integers{kernel, kernel}},
                                      {"strides", Integers{stride, stride}}};
  call.inputs.push_back("weights/" + layer.name + ".weight");
  call.inputs.push_back("weights/" + layer.name + ".bias");
  if (layer.op == Op::kConvTransposed) return call.node("ConvTranspose", attributes);
  attributes.emplace_back("pads", Integers(4, kernel == stride ? 0 : kernel / 2));
  return call.node("Conv", attributes);
}

/// ONNX orders the result with pixels of a block before channels, whereas Op::kPixelUnshuffle has channels first.
std::string add_unshuffle(OnnxCall& call) {
  const size_t channels = call.input_shapes.front().channels, area = call.layer.stride * call.layer.stride;
  Integers order;
  for (size_t c = 0; c < channels; ++c) {
    for (size_t pixel = 0; pixel < area; ++pixel) order.push_back(static_cast<int64_t>(pixel * channels + c));
  }
  const std::string blocks = call.graph.add_node("SpaceToDepth", call.inputs, "blocks/" + call.layer.name,
                                                 {{"blocksize", static_cast<int64_t>(call.layer.stride)}});
  const std::string indices = call.graph.add_constant("orders/" + call.layer.name, order);
  return call.graph.add_node("Gather", {blocks, indices}, call.output, {{"axis", int64_t{1}}});
}

std::string add_shuffle(OnnxCall& call) {
  return call.node("DepthToSpace",
                   {{"blocksize", static_cast<int64_t>(call.layer.stride)}, {"mode", std::string("CRD")}});
}

std::string add_upsampling(OnnxCall& call) {
  return call.resize({{"mode", std::string("nearest")},
                      {"coordinate_transformation_mode", std::string("asymmetric")},
                      {"nearest_mode", std::string("floor")}});
}

using Export = std::string (*)(OnnxCall& call);

/// Returns the function that adds an operation, or null.
Export export_of(const std::string& op) {
  static const std::map<std::string, Export> known = {
      {Op::kConv, add_convolution},
      {Op::kConvTransposed, add_convolution},
      {Op::kPixelUnshuffle, add_unshuffle},
      {Op::kPixelShuffle, add_shuffle},
      {Op::kUpsample, add_upsampling},
      {Op::kAdd, [](OnnxCall& call) { return call.node("Sum"); }},
      {Op::kMean, [](OnnxCall& call) { return call.node("Mean"); }},
      {Op::kConcat,
       [](OnnxCall& call) {
         return call.node("Concat", {{"axis", int64_t{1}}});
       }},
      {Op::kSigmoid, [](OnnxCall& call) { return call.node("Sigmoid"); }}};
  const auto found = known.find(op);
  return found != known.end() ? found->second : find_operation(op)->onnx;
}

}  // namespace

std::string OnnxCall::resize(const OnnxGraph::Attributes& attributes) {
  const auto stride = static_cast<float>(layer.stride);
  const std::vector<float> scales = {1.0F, 1.0F, stride, stride};
  const size_t size = scales.size();
  const std::string name = graph.add_constant("scales/" + layer.name, std::span(&size, 1), scales);
  return graph.add_node("Resize", {inputs.front(), "", name}, output, attributes);
}

std::string OnnxCall::slice(const std::string& tensor, size_t begin, size_t end, const std::string& name) {
  std::vector<std::string> inputs_of_slice = {tensor};
  for (const auto& [part, value] :
       {std::pair{"/begin", begin}, std::pair{"/end", end}, std::pair{"/axis", size_t{1}}}) {
    inputs_of_slice.push_back(graph.add_constant(name + part, Integers{static_cast<int64_t>(value)}));
  }
  return graph.add_node("Slice", inputs_of_slice, name);
}

std::string onnx_refusal(const Network& network) {
  for (const Layer& layer : network.layers) {
    if (export_of(layer.op) == nullptr) return cat("layer \"", layer.name, "\" is the operation ", layer.op);
  }
  return "";
}

std::string add_onnx_layers(OnnxGraph& graph, const Network& network, const Weights& weights,
                            const std::string& input) {
  for (const WeightShape& tensor : weight_shapes(network)) {
    graph.add_constant("weights/" + tensor.name, tensor.shape, weights.at(tensor.name));
  }
  const std::vector<LayerShape> shapes = infer_shapes(network).value();
  std::map<std::string, std::pair<std::string, LayerShape>> tensors = {{"input", {input, {network.input_channels, 1}}}};
  std::string result;
  for (size_t i = 0; i < network.layers.size(); ++i) {
    const Layer& layer = network.layers[i];
    const bool adds = !layer.residual.empty();
    OnnxCall call{graph, layer, {}, {}, (adds || layer.relu ? "linear/" : "layers/") + layer.name};
    for (const std::string& name : layer.inputs) {
      call.inputs.push_back(tensors.at(name).first);
      call.input_shapes.push_back(tensors.at(name).second);
    }
    result = export_of(layer.op)(call);
    if (adds) {
      const std::string name = (layer.relu ? "sums/" : "layers/") + layer.name;
      result = graph.add_node("Add", {result, tensors.at(layer.residual).first}, name);
    }
    if (layer.relu) result = graph.add_node("Relu", {result}, "layers/" + layer.name);
    tensors[layer.name] = {result, shapes[i]};
  }
  return result;
}

}  // namespace e2lf::model
