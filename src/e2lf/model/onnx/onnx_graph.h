// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "e2lf/model/onnx/protobuf_message.h"

namespace e2lf::model {

/// A graph of ONNX operations (IR version 8, opset 17, onnx.ai/onnx/operators), and its file. A tensor is known by its
/// name, which only one call may make.
class OnnxGraph {
 public:
  using Attribute = std::variant<int64_t, std::string, std::vector<int64_t>>;
  using Attributes = std::vector<std::pair<std::string, Attribute>>;

  /// A size along one axis: a number, or a name where it is known only when the graph runs.
  using Extent = std::variant<int64_t, std::string>;

  /// What the graph takes and gives: float32 tensors.
  void add_input(const std::string& name, const std::vector<Extent>& shape);
  void add_output(const std::string& name, const std::vector<Extent>& shape);

  /// A constant tensor: float32 of a shape, one float32, or int64 along one axis. Returns its name.
  std::string add_constant(const std::string& name, std::span<const size_t> shape, std::span<const float> values);
  std::string add_constant(const std::string& name, float value);
  std::string add_constant(const std::string& name, std::span<const int64_t> values);

  /// An operation with one output, which is called `output`. Returns that name.
  std::string add_node(const std::string& operation, const std::vector<std::string>& inputs, const std::string& output,
                       const Attributes& attributes = {});

  /// The whole file, a ModelProto; `metadata` are texts by key.
  [[nodiscard]] std::string file(const std::string& name,
                                 std::span<const std::pair<std::string, std::string>> metadata) const;

 private:
  ProtobufMessage nodes_, constants_, inputs_, outputs_;  ///< parts of a GraphProto
};

}  // namespace e2lf::model
