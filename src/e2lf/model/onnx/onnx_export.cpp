// SPDX-License-Identifier: MIT
#include "e2lf/model/onnx/onnx_export.h"

#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/files/options.h"
#include "e2lf/model/depth_network.h"
#include "e2lf/model/onnx/onnx_graph.h"
#include "e2lf/model/onnx/onnx_layers.h"

namespace e2lf::model {
namespace {

using Integers = std::vector<int64_t>;

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
  return Error{
      ErrorCode::kUnsupported,
      cat("the weights take ", bytes >> 20, " MiB, but an ONNX file can hold at most 2 GiB; use a smaller network"),
      model.name};
}

/// Extends the images at the bottom and right to multiples of what the network needs by repeating the last row and
/// column. Returns the extended images and both sizes.
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
  const std::string none = graph.add_constant("padding/none", Integers(6, 0));
  const std::string pads = graph.add_node("Concat", {none, missing}, "padding/pads", {{"axis", int64_t{0}}});
  size.padded = graph.add_node("Add", {size.given, missing}, "padding/padded");
  return {graph.add_node("Pad", {"events", pads}, "padding/events", {{"mode", std::string("edge")}}), size};
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
  const size_t transitions = model.num_patterns - 1;
  OnnxGraph graph;
  graph.add_input("events", {"batch", static_cast<int64_t>(transitions), "y", "x"});
  if (is_conditioned_on_camera(model)) {
    graph.add_input("traits", {"batch", static_cast<int64_t>(capture::conditioning_size(model.num_patterns))});
  }
  const bool is_depth = is_depth_network(model);
  const std::string output = is_depth ? "disparity" : "views";
  graph.add_output(output,
                   {"batch", static_cast<int64_t>(is_depth ? kDepthOutputs : model.views_y * model.views_x), "y", "x"});
  const auto [events, size] = add_padding(graph, size_multiple(model.network));
  const std::string planes =
      add_onnx_input(graph, model.input, transitions, camera_of(model).constants, events, "traits", size);
  add_crop(graph, add_onnx_layers(graph, model.network, model.weights, planes), size, output);
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
