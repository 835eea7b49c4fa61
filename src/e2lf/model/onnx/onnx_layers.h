// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "e2lf/model/model.h"
#include "e2lf/model/onnx/onnx_graph.h"

/// The parts that onnx_export.h is made of; not for other modules.
namespace e2lf::model {

/// A spatial size inside a graph: the names of int64 tensors [2] = (y, x).
struct OnnxSize {
  std::string given;   ///< of the event images
  std::string padded;  ///< a multiple of what the network needs
};

/// Adds the input planes of `groups` (see InputKind), made of the event images `events` [batch, N-1, y, x] and `traits`
/// [batch, C] (not read where no group is of the camera). `constants` are for intensities. Returns the name of the
/// planes [batch, channel, y, x].
[[nodiscard]] std::string add_onnx_input(OnnxGraph& graph, const std::vector<InputGroup>& groups, size_t transitions,
                                         const capture::SensorConstants& constants, const std::string& events,
                                         const std::string& traits, const OnnxSize& size);

/// Why a network cannot be exported, naming the layer; "" = it can.
[[nodiscard]] std::string onnx_refusal(const Network& network);

/// Adds the layers of a network that passes infer_shapes() and that onnx_refusal() has nothing against, with all its
/// weights. Returns the name of the last one's output.
[[nodiscard]] std::string add_onnx_layers(OnnxGraph& graph, const Network& network, const Weights& weights,
                                          const std::string& input);

}  // namespace e2lf::model
