// SPDX-License-Identifier: MIT
// Converts networks from and to JSON; declared in network.h.
#include <cmath>

#include "e2lf/base/text.h"
#include "e2lf/model/network.h"
#include "e2lf/model/operation.h"

namespace e2lf::model {
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
