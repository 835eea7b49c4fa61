// SPDX-License-Identifier: MIT
#include "e2lf/model/onnx/onnx_export.h"

#include <cmath>
#include <map>
#include <span>

#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/files/options.h"
#include "e2lf/model/operation.h"

namespace e2lf::model {

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
    if (find_operation(layer.op)->onnx == nullptr) return cat("layer \"", layer.name, "\" is the operation ", layer.op);
  }
  return "";
}

namespace {

/// Adds the layers of a network, with all its weights. Returns the name of the output of the last layer.
std::string add_layers(OnnxGraph& graph, const Network& network, const Weights& weights, const std::string& input) {
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
    result = find_operation(layer.op)->onnx(call);
    if (adds) {
      const std::string name = (layer.relu ? "sums/" : "layers/") + layer.name;
      result = graph.add_node("Add", {result, tensors.at(layer.residual).first}, name);
    }
    if (layer.relu) result = graph.add_node("Relu", {result}, "layers/" + layer.name);
    tensors[layer.name] = {result, shapes[i]};
  }
  return result;
}

/// A spatial size inside a graph: the names of int64 tensors [2] = (y, x).
struct OnnxSize {
  std::string given;   ///< name of the event images
  std::string padded;  ///< a multiple of what the network needs
};

/// Makes the input planes [batch, channel, y, x] of a model from the event images `events` [batch, N-1, y, x] and the
/// input "traits". Tensors that several groups need are made only once.
class InputForms {
 public:
  InputForms(OnnxGraph& graph, const Model& model, const capture::SensorConstants& constants, std::string events,
             OnnxSize size)
      : graph_(graph), model_(model), constants_(constants), events_(std::move(events)), size_(std::move(size)) {}

  std::string planes() {
    std::vector<std::string> planes;
    for (const InputGroup& group : model_.input) {
      const std::string& form = form_of(group.kind);
      const size_t number = planes.size();
      const std::string scale = graph_.add_constant(cat("input/scale", number), group.scale);
      planes.push_back(graph_.add_node("Mul", {form, scale}, cat("input/group", number)));
    }
    return graph_.add_node("Concat", planes, "input/planes", {{"axis", int64_t{1}}});
  }

 private:
  const std::string& form_of(InputKind kind) {
    std::string& form = made_[kind];
    if (form.empty()) form = make(kind);
    return form;
  }

  std::string make(InputKind kind) {
    if (kind == InputKind::kCounts) return events_;
    if (kind == InputKind::kLevel) return level();
    if (kind == InputKind::kIntensity) return intensity();
    if (kind == InputKind::kCamera) return camera_planes();
    E2LF_REQUIRE(kind == InputKind::kCumulative, "an exported model takes event images alone");
    const std::string axis = graph_.add_constant("input/channel_axis", Integers{1});
    return graph_.add_node("CumSum", {events_, axis}, "input/cumulative");
  }

  std::string number(const char* name, double value) { return graph_.add_constant(name, static_cast<float>(value)); }

  /// Returns L_k of kLevel.
  std::string level() {
    const std::string half = graph_.add_node("Mul", {last_change(), number("input/half", 0.5)}, "input/half_steps");
    return graph_.add_node("Add", {form_of(InputKind::kCumulative), half}, "input/steps");
  }

  /// Returns min(J_k, 1) of kIntensity. The exponent is limited to the value at which J_k is 1, so that no count
  /// overflows.
  std::string intensity() {
    const double eps = constants_.eps;
    const std::string steps = form_of(InputKind::kLevel);
    std::string x = graph_.add_node("Mul", {steps, number("input/tau", constants_.tau)}, "input/log_steps");
    x = graph_.add_node("Min", {x, number("input/white_log", std::log1p(1.0 / eps))}, "input/log");
    x = graph_.add_node("Exp", {x}, "input/exp");
    x = graph_.add_node("Sub", {x, number("input/black", 1.0)}, "input/above_black");
    return graph_.add_node("Mul", {x, number("input/eps", eps)}, "input/intensity");
  }

  /// Returns s_k of kLevel.
  std::string last_change() {
    const std::string one = number("input/one", 1.0);
    const std::string signs = graph_.add_node("Sign", {events_}, "input/signs");
    std::vector<std::string> changes;
    for (size_t k = 0; k + 1 < model_.num_patterns; ++k) {
      const std::string index = graph_.add_constant(cat("input/k", k), Integers{static_cast<int64_t>(k)});
      std::string sign = graph_.add_node("Gather", {signs, index}, cat("input/sign", k), {{"axis", int64_t{1}}});
      if (k > 0) {
        // 1 if this count is zero, in which case the previous sign is kept.
        const std::string changed = graph_.add_node("Abs", {sign}, cat("input/changed", k));
        const std::string still = graph_.add_node("Sub", {one, changed}, cat("input/still", k));
        const std::string kept = graph_.add_node("Mul", {still, changes.back()}, cat("input/kept", k));
        sign = graph_.add_node("Add", {sign, kept}, cat("input/change", k));
      }
      changes.push_back(sign);
    }
    return graph_.add_node("Concat", changes, "input/last_change", {{"axis", int64_t{1}}});
  }

  /// Expands each number of the conditioning vector to a constant plane.
  std::string camera_planes() {
    const std::string axes = graph_.add_constant("input/image_axes", Integers{2, 3});
    const std::string pixels = graph_.add_node("Unsqueeze", {"traits", axes}, "input/trait_pixels");
    const std::string ones = graph_.add_constant("input/ones", Integers{1, 1});
    const std::string shape =
        graph_.add_node("Concat", {ones, size_.padded}, "input/trait_shape", {{"axis", int64_t{0}}});
    return graph_.add_node("Expand", {pixels, shape}, "input/camera");
  }

  OnnxGraph& graph_;
  const Model& model_;
  const capture::SensorConstants& constants_;
  std::string events_;
  OnnxSize size_;
  std::map<InputKind, std::string> made_;
};

// The limit leaves ample room for everything except the weights within 2 GiB.
constexpr size_t kMostWeights = (size_t{2} << 30) - (size_t{256} << 20);

/// Returns the default camera of the model.
capture::SensorProfile camera_of(const Model& model) {
  if (model.camera) return *model.camera;
  capture::SensorProfile camera;
  camera.constants = model.constants;
  return camera;
}

Result<void> check_size(const Model& model) {
  size_t bytes = 0;
  for (const auto& [name, values] : model.weights) bytes += values.size() * sizeof(float);
  if (bytes <= kMostWeights) return {};
  return fail(ErrorCode::kUnsupported, model.name, "the weights take ", bytes >> 20,
              " MiB, but an ONNX file can hold at most 2 GiB; use a smaller network");
}

/// Continues the images along an axis to `padded` pixels by their mirror image.
std::string add_mirror(OnnxGraph& graph, const std::string& images, const OnnxSize& size, int64_t axis) {
  const std::string name = cat("padding/", axis == 2 ? "y" : "x");
  const auto constant = [&](const char* what, int64_t value) {
    return graph.add_constant(cat(name, "_", what), Integers{value});
  };
  const auto node = [&](const char* operation, const std::vector<std::string>& inputs, const char* what) {
    return graph.add_node(operation, inputs, cat(name, "_", what));
  };
  const std::string number = constant("axis", axis - 2), one = constant("one", 1);
  const std::string twice = node("Mul", {node("Gather", {size.given, number}, "given"), constant("two", 2)}, "twice");
  const auto scalar = [&](const std::string& of, const char* what) { return node("Squeeze", {of}, what); };
  const std::string end = scalar(node("Gather", {size.padded, number}, "padded"), "end");
  const std::string places = node("Range", {scalar(constant("zero", 0), "begin"), end, scalar(one, "step")}, "places");
  const std::string wrapped = node("Mod", {places, twice}, "wrapped");
  const std::string back = node("Sub", {node("Sub", {twice, one}, "last"), wrapped}, "back");
  return graph.add_node("Gather", {images, node("Min", {wrapped, back}, "index")}, cat(name, "_mirrored"),
                        {{"axis", axis}});
}

/// Extends the images at the bottom and right to multiples of what the network needs by their mirror images. Returns
/// the extended images and both sizes.
std::pair<std::string, OnnxSize> add_padding(OnnxGraph& graph, size_t multiple) {
  OnnxSize size;
  size.given = graph.add_node("Shape", {"events"}, "padding/given", {{"start", int64_t{2}}, {"end", int64_t{4}}});
  if (multiple == 1) {
    size.padded = size.given;
    return {"events", size};
  }
  const std::string step = graph.add_constant("padding/multiple", Integers{static_cast<int64_t>(multiple)});
  const std::string negative = graph.add_node("Neg", {size.given}, "padding/negative");
  // The remainder has the sign of the divisor, so it is not negative.
  const std::string missing = graph.add_node("Mod", {negative, step}, "padding/missing");
  size.padded = graph.add_node("Add", {size.given, missing}, "padding/padded");
  return {add_mirror(graph, add_mirror(graph, "events", size, 2), size, 3), size};
}

void add_crop(OnnxGraph& graph, const std::string& whole, const OnnxSize& size, const std::string& output) {
  const std::string begin = graph.add_constant("crop/begin", Integers{0, 0});
  const std::string axes = graph.add_constant("crop/axes", Integers{2, 3});
  graph.add_node("Slice", {whole, begin, size.given, axes}, output);
}

}  // namespace

Result<std::string> onnx_file(const Model& model) {
  E2LF_RETURN_IF_ERROR(validate(model, model.name));
  E2LF_RETURN_IF_ERROR(check_size(model));
  if (model.measurement() != capture::MeasurementKind::kEventImages) {
    return fail(ErrorCode::kUnsupported, model.name, "exported networks take event images; this one takes ",
                capture::measurement_name(model.measurement()), "; export a model of event images");
  }
  if (const std::string refusal = onnx_refusal(model.network); !refusal.empty()) {
    return fail(ErrorCode::kUnsupported, model.name, refusal, ", which is not exported; export another network");
  }
  OnnxGraph graph;
  graph.add_input("events", {"batch", static_cast<int64_t>(model.num_patterns - 1), "y", "x"});
  if (is_conditioned_on_camera(model)) {
    graph.add_input("traits", {"batch", static_cast<int64_t>(capture::conditioning_size(model.num_patterns))});
  }
  const bool is_depth = is_depth_network(model);
  const std::string output = is_depth ? "disparity" : "views";
  graph.add_output(output,
                   {"batch", static_cast<int64_t>(is_depth ? kDepthOutputs : model.views_y * model.views_x), "y", "x"});
  const auto [events, size] = add_padding(graph, size_multiple(model.network));
  const capture::SensorConstants constants = camera_of(model).constants;
  const std::string planes = InputForms(graph, model, constants, events, size).planes();
  add_crop(graph, add_layers(graph, model.network, model.weights, planes), size, output);
  return graph.file(model.name, onnx_metadata(model));
}

std::vector<std::pair<std::string, std::string>> onnx_metadata(const Model& model) {
  const capture::SensorProfile camera = camera_of(model);
  const Json constants = {{"eps", json_number(camera.constants.eps)},
                          {"tau", json_number(camera.constants.tau)},
                          {"sigma_w", json_number(camera.constants.sigma_w)},
                          {"sigma_z", json_number(camera.constants.sigma_z)}};
  std::vector<std::pair<std::string, std::string>> metadata = {{"name", model.name},
                                                               {"event_model", model.event_model},
                                                               {"event_constants", json_line(constants)},
                                                               {"num_patterns", std::to_string(model.num_patterns)},
                                                               {"view_order", "VV_UU"},
                                                               {"views_y", std::to_string(model.views_y)},
                                                               {"views_x", std::to_string(model.views_x)}};
  if (model.codes) metadata.emplace_back("patterns", json_line(capture::codes_to_json(*model.codes)));
  if (!is_conditioned_on_camera(model)) return metadata;
  Json conditioning = Json::array();
  for (const float trait : capture::conditioning_vector(camera, model.num_patterns))
    conditioning.push_back(json_number(trait));
  metadata.emplace_back("camera", json_line(capture::to_json(camera)));
  metadata.emplace_back("traits", json_line(conditioning));
  return metadata;
}

}  // namespace e2lf::model
