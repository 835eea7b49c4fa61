// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace e2lf::model {

/// Writes a message in the wire format of protobuf (protobuf.dev/programming-guides/encoding), field after field in the
/// order of the calls. A field is identified by its number, 1 to 2^29 - 1.
class ProtobufMessage {
 public:
  /// Adds an int32, int64 or enumeration as a varint, which takes ten bytes for negative numbers.
  void add_integer(uint32_t field, int64_t value);

  /// Adds a string or bytes, preceded by their length.
  void add_bytes(uint32_t field, std::string_view value);

  /// Adds a nested message.
  void add_message(uint32_t field, const ProtobufMessage& message) { add_bytes(field, message.bytes_); }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  void add_key(uint32_t field, uint32_t wire_type);
  void add_varint(uint64_t value);
  std::string bytes_;
};

/// The value of an attribute, or a constant along one axis, of a graph.
using Integers = std::vector<int64_t>;

/// A graph of ONNX operations (IR version 8, opset 17, onnx.ai/onnx/operators). A tensor is identified by its name,
/// which may be defined by one call only.
class OnnxGraph {
 public:
  using Attribute = std::variant<int64_t, std::string, Integers>;
  using Attributes = std::vector<std::pair<std::string, Attribute>>;

  /// A size along one axis: a number, or a name if it is known only at run time.
  using Extent = std::variant<int64_t, std::string>;

  /// Declare an input or output of the graph, which is a float32 tensor.
  void add_input(const std::string& name, const std::vector<Extent>& shape);
  void add_output(const std::string& name, const std::vector<Extent>& shape);

  /// Adds a constant tensor, which is float32 with a shape, a single float32, or int64 along one axis. Returns its
  /// name.
  std::string add_constant(const std::string& name, std::span<const size_t> shape, std::span<const float> values);
  std::string add_constant(const std::string& name, float value);
  std::string add_constant(const std::string& name, std::span<const int64_t> values);

  /// Adds an operation with one output, which gets the name `output`. Returns that name.
  std::string add_node(const std::string& operation, const std::vector<std::string>& inputs, const std::string& output,
                       const Attributes& attributes = {});

  /// Returns the whole file, a ModelProto. `metadata` are texts by key.
  [[nodiscard]] std::string file(const std::string& name,
                                 std::span<const std::pair<std::string, std::string>> metadata) const;

 private:
  ProtobufMessage nodes_, constants_, inputs_, outputs_;  ///< parts of a GraphProto
};

}  // namespace e2lf::model
