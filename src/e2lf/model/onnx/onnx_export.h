// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/model/model.h"
#include "e2lf/model/onnx/onnx_graph.h"

/// What operations need to export themselves.
namespace e2lf::model {

/// A layer to be added to a graph. Tensors that it needs beside its output are named "<prefix>/<layer>" with a prefix
/// of their own.
struct OnnxCall {
  OnnxGraph& graph;
  const Layer& layer;
  std::vector<std::string> inputs;  ///< tensors
  std::vector<LayerShape> input_shapes;
  std::string output;  ///< the name that the result must have

  /// Adds a node with these inputs and the output of the layer.
  std::string node(const std::string& operation, const OnnxGraph::Attributes& attributes = {}) {
    return graph.add_node(operation, inputs, output, attributes);
  }

  /// Adds the channels [begin, end) of a tensor as `name`.
  std::string slice(const std::string& tensor, size_t begin, size_t end, const std::string& name);

  /// Adds a resampling to `stride` times the size.
  std::string resize(const OnnxGraph::Attributes& attributes);
};

/// Returns why a network cannot be exported, naming the layer, or "" if it can.
[[nodiscard]] std::string onnx_refusal(const Network& network);

/// Exports a model as an ONNX file (opset 17, float32 weights) with these float32 tensors:
///  - input `events` [batch, N-1, y, x]: the counts of each transition, or their means over several cycles;
///  - input `traits` [batch, C], only if is_conditioned_on_camera(): the conditioning vector,
///  capture::conditioning_vector();
///  - output `views` [batch, views, y, x]: the unprocessed network output; view number = views_x * view_y + view_x; or,
///  if is_depth_network(), `disparity` [batch, kDepthOutputs, y, x].
///
/// Images may have any size: the graph extends them to multiples of size_multiple() as recon::network_input() does, and
/// crops the views. Intensities are computed with the constants of model.camera, or with model.constants if it is
/// absent. onnx_metadata() describes the metadata. Fails as validate() does, and with kUnsupported if the model takes
/// another measurement than event images, has a layer that cannot be exported, or would exceed the limit of protobuf
/// messages (2 GiB).
[[nodiscard]] Result<std::string> onnx_file(const Model& model);

/// Returns the metadata as texts by key: name, event_model, event_constants (JSON: eps, tau, sigma_w, sigma_z),
/// num_patterns, view_order ("VV_UU": row by row), views_y, views_x and, if the model has patterns, patterns (JSON, as
/// capture::codes_to_json()). Networks conditioned on the sensor profile also have camera (JSON) and traits (JSON: the
/// conditioning vector for one cycle of this camera).
[[nodiscard]] std::vector<std::pair<std::string, std::string>> onnx_metadata(const Model& model);

}  // namespace e2lf::model
