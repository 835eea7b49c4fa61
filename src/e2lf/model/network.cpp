// SPDX-License-Identifier: MIT
#include "e2lf/model/network.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "e2lf/base/text.h"
#include "e2lf/model/operation.h"

namespace e2lf::model {
namespace {

using Shapes = std::map<std::string, LayerShape>;

Error invalid_layer(const std::string& message) {
  return fail(ErrorCode::kInvalidValue, "", message);
}

Result<LayerShape> find_shape(const Shapes& known, const std::string& name) {
  const auto found = known.find(name);
  if (found != known.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& entry : known) names.push_back(entry.first);
  return invalid_layer(cat("no earlier layer is named \"", name, "\"; ", suggestion(name, names)));
}

Result<void> check_stride(const Layer& layer, const Operation& operation) {
  if (layer.stride == 0 || layer.stride > kMaxScale) {
    return invalid_layer(cat("the stride ", layer.stride, " is out of range; use 1 to ", kMaxScale));
  }
  if (operation.takes_stride_and_relu) return {};
  if (layer.stride != 1) return invalid_layer("this operation does not support a stride; use stride 1");
  if (layer.relu) return invalid_layer("this operation does not support ReLU; remove it");
  return {};
}

Result<void> check_residual(const Layer& layer, const Shapes& known, const LayerShape& shape) {
  if (layer.residual.empty()) return {};
  if (layer.op != Op::kConv) return invalid_layer("only the operation conv supports a residual; use an add layer");
  E2LF_ASSIGN_OR_RETURN(const LayerShape residual, find_shape(known, layer.residual));
  if (residual.channels == shape.channels && residual.scale == shape.scale) return {};
  return fail(ErrorCode::kShape, "", "the residual has ", residual.channels, " channels at scale ", residual.scale,
              ", but the output has ", shape.channels, " at ", shape.scale, "; make them equal");
}

/// Infers the shape of one layer and returns the first problem found, without a location.
Result<LayerShape> infer_shape(const Layer& layer, const Shapes& known) {
  if (layer.name.empty()) return invalid_layer("the layer has no name; add one");
  if (known.contains(layer.name)) return invalid_layer("an earlier layer has the same name; choose another one");
  const Operation* operation = find_operation(layer.op);
  if (operation == nullptr) return unknown_operation(layer.op, "");
  for (const auto& entry : layer.attributes) {
    if (std::ranges::find(operation->attributes, entry.first) != operation->attributes.end()) continue;
    return invalid_layer(cat("this operation has no attribute \"", entry.first, "\"; remove it"));
  }
  std::vector<LayerShape> inputs;
  for (const std::string& name : layer.inputs) {
    E2LF_ASSIGN_OR_RETURN(inputs.emplace_back(), find_shape(known, name));
  }
  if (inputs.size() < operation->min_inputs || inputs.size() > operation->max_inputs) {
    return invalid_layer(cat("the layer has ", inputs.size(), " inputs; this operation takes ", operation->min_inputs,
                             operation->max_inputs > operation->min_inputs ? " or more" : ""));
  }
  E2LF_RETURN_IF_ERROR(check_stride(layer, *operation));
  E2LF_ASSIGN_OR_RETURN(const LayerShape shape, operation->shape(layer, inputs));
  if (shape.channels == 0 || shape.channels > kMaxChannels) {
    return invalid_layer(cat("the layer has ", shape.channels, " channels; use 1 to ", kMaxChannels));
  }
  if (shape.scale > kMaxScale)
    return invalid_layer(cat("the scale ", shape.scale, " is too large; use at most ", kMaxScale));
  E2LF_RETURN_IF_ERROR(check_residual(layer, known, shape));
  return shape;
}

/// Checks that the output that is fed back to the next frame has the shape that its layer states.
Result<void> check_feedback(const Network& network, const LayerShape& output) {
  for (const Layer& layer : network.layers) {
    if (!find_operation(layer.op)->is_last_output) continue;
    const std::string location = cat("layer \"", layer.name, "\"");
    if (&layer == &network.layers.back()) {
      return fail(ErrorCode::kInvalidValue, location, "the last layer cannot be its own previous output; add a layer");
    }
    if (output.channels == layer.out_channels && output.scale == 1) continue;
    return fail(ErrorCode::kShape, location, "the previous output has ", layer.out_channels,
                " channels, but the last layer has ", output.channels, " at scale ", output.scale,
                "; make them equal at scale 1");
  }
  return {};
}

/// Calls `visit` with each layer of a valid network, its operation, and the shapes of its inputs and output.
void for_each_layer(const Network& network,
                    const std::function<void(const Layer&, const Operation&, std::span<const LayerShape> inputs,
                                             const LayerShape& output)>& visit) {
  const std::vector<LayerShape> shapes = infer_shapes(network).value();
  Shapes known = {{"input", {network.input_channels, 1}}};
  for (size_t i = 0; i < shapes.size(); ++i) {
    const Layer& layer = network.layers[i];
    std::vector<LayerShape> inputs;
    for (const std::string& name : layer.inputs) inputs.push_back(known.at(name));
    visit(layer, *find_operation(layer.op), inputs, shapes[i]);
    known.emplace(layer.name, shapes[i]);
  }
}

std::vector<WeightShape> weights_of(const Operation& operation, const Layer& layer,
                                    std::span<const LayerShape> inputs) {
  return operation.weights != nullptr ? operation.weights(layer, inputs) : std::vector<WeightShape>();
}

Layer conv(const std::string& name, const std::string& input, size_t out_channels, size_t kernel) {
  return {.name = name, .inputs = {input}, .out_channels = out_channels, .kernel = kernel};
}

}  // namespace

size_t Layer::integer(const std::string& attribute, size_t otherwise) const {
  const auto found = attributes.find(attribute);
  if (found == attributes.end()) return otherwise;
  constexpr double kMost = 1e9;
  const double value = found->second.size() == 1 ? found->second.front() : 0.0;
  return value > 0.0 && value < kMost && value == std::floor(value) ? static_cast<size_t>(value) : 0;
}

size_t WeightShape::size() const {
  return std::accumulate(shape.begin(), shape.end(), size_t{1}, std::multiplies<>());
}

Result<std::vector<LayerShape>> infer_shapes(const Network& network) {
  if (network.input_channels == 0 || network.input_channels > kMaxChannels) {
    return fail(ErrorCode::kInvalidValue, "input_channels", "there are ", network.input_channels,
                " input channels; use 1 to ", kMaxChannels);
  }
  if (network.layers.empty())
    return fail(ErrorCode::kInvalidValue, "layers", "the network has no layers; add at least one");
  Shapes known = {{"input", {network.input_channels, 1}}};
  std::vector<LayerShape> shapes;
  size_t multiple = 1;
  for (const Layer& layer : network.layers) {
    const std::string location = cat("layer \"", layer.name, "\"");
    const auto shape = infer_shape(layer, known);
    if (!shape) return Error{shape.error().code, shape.error().message, location};
    multiple = std::lcm(multiple, shape->scale);
    if (multiple > kMaxScale) {
      return fail(ErrorCode::kInvalidValue, location, "images would have to be multiples of ", multiple,
                  " pixels; use at most ", kMaxScale);
    }
    known.emplace(layer.name, *shape);
    shapes.push_back(*shape);
  }
  E2LF_RETURN_IF_ERROR(check_feedback(network, shapes.back()));
  return shapes;
}

size_t size_multiple(const Network& network) {
  size_t multiple = 1;
  for (const LayerShape& shape : infer_shapes(network).value()) multiple = std::lcm(multiple, shape.scale);
  return multiple;
}

bool is_recurrent(const Network& network) {
  return std::any_of(network.layers.begin(), network.layers.end(),
                     [](const Layer& layer) { return find_operation(layer.op)->remembers; });
}

std::vector<WeightShape> weight_shapes(const Network& network) {
  std::vector<WeightShape> result;
  for_each_layer(network, [&](const Layer& layer, const Operation& operation, auto inputs, const LayerShape&) {
    for (WeightShape& tensor : weights_of(operation, layer, inputs)) {
      tensor.layer = static_cast<size_t>(&layer - network.layers.data());
      result.push_back(std::move(tensor));
    }
  });
  return result;
}

double macs_per_pixel(const Network& network) {
  double sum = 0.0;
  for_each_layer(network, [&](const Layer& layer, const Operation& operation, auto inputs, const LayerShape& output) {
    double macs = 0.0;
    if (operation.macs != nullptr) {
      macs = operation.macs(layer, inputs);
    } else {
      for (const WeightShape& tensor : weights_of(operation, layer, inputs)) {
        if (tensor.shape.size() == 4) macs += static_cast<double>(tensor.size());
      }
    }
    sum += macs / static_cast<double>(output.scale * output.scale);
  });
  return sum;
}

size_t num_parameters(const Network& network) {
  size_t sum = 0;
  for (const WeightShape& tensor : weight_shapes(network)) sum += tensor.size();
  return sum;
}

size_t receptive_radius(const Network& network) {
  // A pixel at scale s represents a block of s input pixels. The radius counts the context beyond that block.
  std::map<std::string, size_t> radius = {{"input", 0}};
  bool is_whole_image = false;
  for_each_layer(network, [&](const Layer& layer, const Operation& operation, auto inputs, const LayerShape& output) {
    size_t& of_layer = radius[layer.name];
    const size_t reach = operation.reach != nullptr ? operation.reach(layer) : 0;
    is_whole_image |= reach == kWholeImage;
    if (inputs.empty() || is_whole_image) return;
    for (const std::string& input : layer.inputs) of_layer = std::max(of_layer, radius.at(input));
    of_layer += reach * inputs[0].scale;
    // The rest of a coarse block, for the finest pixel at its edge.
    if (output.scale < inputs[0].scale) of_layer += inputs[0].scale - output.scale;
    if (!layer.residual.empty()) of_layer = std::max(of_layer, radius.at(layer.residual));
  });
  return is_whole_image ? kWholeImage : radius.at(network.layers.back().name);
}

Network recnet(size_t input_channels, size_t output_channels, size_t width) {
  constexpr size_t kBodyLayers = 20;
  Network network;
  network.input_channels = input_channels;
  network.layers = {conv("conv1", "input", width, 5), conv("conv2", "conv1", width, 5),
                    conv("conv3", "conv2", output_channels, 5)};
  for (size_t i = 1; i <= kBodyLayers; ++i) {
    const bool last = i == kBodyLayers;
    Layer layer = conv(cat("l", i), network.layers.back().name, last ? output_channels : width, 3);
    layer.relu = !last;
    if (last) layer.residual = "conv3";
    network.layers.push_back(std::move(layer));
  }
  return network;
}

namespace {

constexpr const char* kType = "conv-graph";

/// Whole numbers are written as such.
Json number_json(double value) {
  constexpr double kMostExact = 9007199254740992.0;  // 2^53
  if (value == std::floor(value) && std::abs(value) < kMostExact) return static_cast<int64_t>(value);
  return value;
}

Json attribute_json(const std::vector<double>& values) {
  if (values.size() == 1) return number_json(values.front());
  Json list = Json::array();
  for (const double value : values) list.push_back(number_json(value));
  return list;
}

Result<std::vector<double>> attribute_from_json(const Json& json, const std::string& location) {
  std::vector<double> values;
  for (const Json& value : json.is_array() ? json : Json::array({json})) {
    if (!value.is_number()) return fail(ErrorCode::kFormat, location, "expected a number or a list of numbers");
    values.push_back(value.get<double>());
  }
  return values;
}

Json layer_to_json(const Layer& layer) {
  const Layer defaults;
  Json json = {{"name", layer.name}, {"op", layer.op}, {"inputs", layer.inputs}};
  if (layer.out_channels != defaults.out_channels) json["out_channels"] = layer.out_channels;
  if (layer.kernel != defaults.kernel) json["kernel"] = layer.kernel;
  if (layer.stride != defaults.stride) json["stride"] = layer.stride;
  for (const auto& [name, values] : layer.attributes) json[name] = attribute_json(values);
  if (!layer.residual.empty()) json["residual"] = layer.residual;
  if (layer.relu) json["relu"] = true;
  return json;
}

Result<Layer> layer_from_json(const Json& json, const std::string& location) {
  Layer layer;
  layer.op.clear();
  OptionReader reader(json, location);
  E2LF_VISIT(layer, reader, name, op, inputs, out_channels, kernel, stride, residual, relu);
  const Operation* operation = find_operation(layer.op);
  if (operation == nullptr) return unknown_operation(layer.op, reader.child_location("op"));
  for (const std::string& name : operation->attributes) {
    const Json& attribute = reader.child(name);
    if (attribute.is_null()) continue;
    E2LF_ASSIGN_OR_RETURN(layer.attributes[name], attribute_from_json(attribute, reader.child_location(name)));
  }
  E2LF_RETURN_IF_ERROR(reader.finish());
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
    return fail(ErrorCode::kUnsupported, reader.child_location("type"), "unknown network type \"", type,
                "\"; this build knows \"", kType, "\"");
  }
  const Json& layers = reader.child("layers");
  E2LF_RETURN_IF_ERROR(reader.finish());
  if (!layers.is_array()) return fail(ErrorCode::kFormat, reader.child_location("layers"), "expected a list of layers");
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

Json network_summary(const Network& network) {
  const size_t radius = receptive_radius(network);
  return {{"type", kType},
          {"layers", network.layers.size()},
          {"parameters", num_parameters(network)},
          {"macs_per_pixel", macs_per_pixel(network)},
          {"receptive_field_px", radius == kWholeImage ? Json() : Json(2 * radius + 1)},
          {"size_multiple_px", size_multiple(network)}};
}

}  // namespace e2lf::model
