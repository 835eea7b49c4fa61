// SPDX-License-Identifier: MIT
// Converts networks from and to JSON; declared in network.h.
#include <algorithm>
#include <utility>

#include "e2lf/base/text.h"
#include "e2lf/model/network.h"

namespace e2lf::model {
namespace {

constexpr const char* kType = "conv-graph";

constexpr std::pair<Op, const char*> kOps[] = {{Op::kConv, "conv"},
                                               {Op::kConvTransposed, "conv-transposed"},
                                               {Op::kPixelUnshuffle, "pixel-unshuffle"},
                                               {Op::kPixelShuffle, "pixel-shuffle"},
                                               {Op::kUpsample, "upsample"},
                                               {Op::kUpsampleBilinear, "upsample-bilinear"},
                                               {Op::kAdd, "add"},
                                               {Op::kMean, "mean"},
                                               {Op::kConcat, "concat"},
                                               {Op::kSigmoid, "sigmoid"},
                                               {Op::kTanh, "tanh"},
                                               {Op::kDynamicFilter, "dynamic-filter"},
                                               {Op::kLayerNorm, "layer-norm"},
                                               {Op::kPositionCode, "position-code"},
                                               {Op::kAttention, "attention"},
                                               {Op::kPrevious, "previous"},
                                               {Op::kConvGru, "conv-gru"},
                                               {Op::kConvLstm, "conv-lstm"}};

const char* op_name(Op op) {
  return std::find_if(std::begin(kOps), std::end(kOps), [&](const auto& entry) { return entry.first == op; })->second;
}

Result<Op> op_from_name(const std::string& name, const std::string& location) {
  std::vector<std::string> names;
  for (const auto& [op, known] : kOps) {
    if (name == known) return op;
    names.emplace_back(known);
  }
  return Error{ErrorCode::kUnsupported, cat("unknown operation \"", name, "\"; known are ", join(names)), location};
}

Json layer_to_json(const Layer& layer) {
  const Layer defaults;
  Json json = {{"name", layer.name}, {"op", op_name(layer.op)}, {"inputs", layer.inputs}};
  if (layer.out_channels != defaults.out_channels) json["out_channels"] = layer.out_channels;
  if (layer.kernel != defaults.kernel) json["kernel"] = layer.kernel;
  if (layer.stride != defaults.stride) json["stride"] = layer.stride;
  if (layer.heads != defaults.heads) json["heads"] = layer.heads;
  if (!layer.residual.empty()) json["residual"] = layer.residual;
  if (layer.relu) json["relu"] = true;
  return json;
}

Result<Layer> layer_from_json(const Json& json, const std::string& location) {
  Layer layer;
  std::string op;
  OptionReader reader(json, location);
  reader.read("name", layer.name)
      .read("op", op)
      .read("inputs", layer.inputs)
      .read("out_channels", layer.out_channels)
      .read("kernel", layer.kernel)
      .read("stride", layer.stride)
      .read("heads", layer.heads)
      .read("residual", layer.residual)
      .read("relu", layer.relu);
  E2LF_RETURN_IF_ERROR(reader.finish());
  E2LF_ASSIGN_OR_RETURN(layer.op, op_from_name(op, reader.child_location("op")));
  return layer;
}

}  // namespace

Json to_json(const Network& network) {
  Json layers = Json::array();
  for (const Layer& layer : network.layers) layers.push_back(layer_to_json(layer));
  return {{"type", kType}, {"input_channels", network.input_channels}, {"layers", std::move(layers)}};
}

Result<Network> network_from_json(const Json& json, const std::string& location) {
  Network network;
  OptionReader reader(json, location);
  std::string type;
  reader.read("type", type).read("input_channels", network.input_channels);
  // The type is checked before the keys, because another type has other keys.
  if (json.is_object() && type != kType) {
    return Error{ErrorCode::kUnsupported, cat("unknown network type \"", type, "\"; this build knows \"", kType, "\""),
                 reader.child_location("type")};
  }
  const Json& layers = reader.child("layers");
  E2LF_RETURN_IF_ERROR(reader.finish());
  if (!layers.is_array())
    return Error{ErrorCode::kFormat, "expected a list of layers", reader.child_location("layers")};
  for (size_t i = 0; i < layers.size(); ++i) {
    const std::string layer_location = cat(reader.child_location("layers"), "[", i, "]");
    E2LF_ASSIGN_OR_RETURN(Layer layer, layer_from_json(layers[i], layer_location));
    network.layers.push_back(std::move(layer));
  }
  if (const auto shapes = infer_shapes(network); !shapes) {
    Error error = shapes.error();
    error.location = cat(location, ": ", error.location);
    return error;
  }
  return network;
}

}  // namespace e2lf::model
