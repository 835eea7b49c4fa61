// SPDX-License-Identifier: MIT
#include "e2lf/model/onnx/onnx_graph.h"

#include "e2lf/base/result.h"

namespace e2lf::model {
namespace {

// The field numbers and types of onnx.proto.
namespace model_proto {
enum : uint32_t { kIrVersion = 1, kProducer = 2, kGraph = 7, kOperators = 8, kMetadata = 14 };
}
namespace operators_proto {
enum : uint32_t { kVersion = 2 };
}
namespace metadata_proto {
enum : uint32_t { kKey = 1, kValue = 2 };
}
namespace graph_proto {
enum : uint32_t { kNode = 1, kName = 2, kConstant = 5, kInput = 11, kOutput = 12 };
}
namespace node_proto {
enum : uint32_t { kInput = 1, kOutput = 2, kName = 3, kOperation = 4, kAttribute = 5 };
}
namespace attribute_proto {
enum : uint32_t { kName = 1, kInteger = 3, kText = 4, kIntegers = 8, kType = 20 };
enum : int64_t { kIsInteger = 2, kIsText = 3, kIsIntegers = 7 };
}  // namespace attribute_proto
namespace tensor_proto {
enum : uint32_t { kExtent = 1, kType = 2, kName = 8, kData = 9 };
enum : int64_t { kFloat32 = 1, kInt64 = 7 };
}  // namespace tensor_proto
namespace value_proto {
enum : uint32_t { kName = 1, kType = 2, kTensor = 1, kElement = 1, kShape = 2, kAxis = 1, kFixed = 1, kNamed = 2 };
}

constexpr int64_t kIrVersion = 8, kOpset = 17;

template <typename T>
std::string_view bytes_of(std::span<const T> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

/// Makes a ValueInfoProto: the name and type of an input or output.
ProtobufMessage value_info(const std::string& name, const std::vector<OnnxGraph::Extent>& shape) {
  ProtobufMessage axes;
  for (const OnnxGraph::Extent& extent : shape) {
    ProtobufMessage axis;
    if (const auto* fixed = std::get_if<int64_t>(&extent)) {
      axis.add_integer(value_proto::kFixed, *fixed);
    } else {
      axis.add_bytes(value_proto::kNamed, std::get<std::string>(extent));
    }
    axes.add_message(value_proto::kAxis, axis);
  }
  ProtobufMessage tensor, type, value;
  tensor.add_integer(value_proto::kElement, tensor_proto::kFloat32);
  tensor.add_message(value_proto::kShape, axes);
  type.add_message(value_proto::kTensor, tensor);
  value.add_bytes(value_proto::kName, name);
  value.add_message(value_proto::kType, type);
  return value;
}

ProtobufMessage attribute_proto_of(const std::string& name, const OnnxGraph::Attribute& value) {
  ProtobufMessage attribute;
  attribute.add_bytes(attribute_proto::kName, name);
  if (const auto* integer = std::get_if<int64_t>(&value)) {
    attribute.add_integer(attribute_proto::kInteger, *integer);
    attribute.add_integer(attribute_proto::kType, attribute_proto::kIsInteger);
  } else if (const auto* text = std::get_if<std::string>(&value)) {
    attribute.add_bytes(attribute_proto::kText, *text);
    attribute.add_integer(attribute_proto::kType, attribute_proto::kIsText);
  } else {
    for (const int64_t each : std::get<Integers>(value)) {
      attribute.add_integer(attribute_proto::kIntegers, each);
    }
    attribute.add_integer(attribute_proto::kType, attribute_proto::kIsIntegers);
  }
  return attribute;
}

ProtobufMessage tensor_of(const std::string& name, std::span<const size_t> shape, int64_t type, std::string_view data) {
  ProtobufMessage tensor;
  for (const size_t extent : shape) tensor.add_integer(tensor_proto::kExtent, static_cast<int64_t>(extent));
  tensor.add_integer(tensor_proto::kType, type);
  tensor.add_bytes(tensor_proto::kName, name);
  tensor.add_bytes(tensor_proto::kData, data);
  return tensor;
}

enum WireType : uint32_t { kVarint = 0, kLengthDelimited = 2 };
constexpr uint32_t kMostFields = (uint32_t{1} << 29) - 1;

}  // namespace

void OnnxGraph::add_input(const std::string& name, const std::vector<Extent>& shape) {
  inputs_.add_message(graph_proto::kInput, value_info(name, shape));
}

void OnnxGraph::add_output(const std::string& name, const std::vector<Extent>& shape) {
  outputs_.add_message(graph_proto::kOutput, value_info(name, shape));
}

std::string OnnxGraph::add_constant(const std::string& name, std::span<const size_t> shape,
                                    std::span<const float> values) {
  constants_.add_message(graph_proto::kConstant, tensor_of(name, shape, tensor_proto::kFloat32, bytes_of(values)));
  return name;
}

std::string OnnxGraph::add_constant(const std::string& name, float value) {
  return add_constant(name, std::span<const size_t>(), std::span(&value, 1));
}

std::string OnnxGraph::add_constant(const std::string& name, std::span<const int64_t> values) {
  const size_t size = values.size();
  constants_.add_message(graph_proto::kConstant,
                         tensor_of(name, std::span(&size, 1), tensor_proto::kInt64, bytes_of(values)));
  return name;
}

std::string OnnxGraph::add_node(const std::string& operation, const std::vector<std::string>& inputs,
                                const std::string& output, const Attributes& attributes) {
  ProtobufMessage node;
  for (const std::string& input : inputs) node.add_bytes(node_proto::kInput, input);
  node.add_bytes(node_proto::kOutput, output);
  node.add_bytes(node_proto::kName, output);
  node.add_bytes(node_proto::kOperation, operation);
  for (const auto& [name, value] : attributes) {
    node.add_message(node_proto::kAttribute, attribute_proto_of(name, value));
  }
  nodes_.add_message(graph_proto::kNode, node);
  return output;
}

std::string OnnxGraph::file(const std::string& name,
                            std::span<const std::pair<std::string, std::string>> metadata) const {
  ProtobufMessage graph_name;
  graph_name.add_bytes(graph_proto::kName, name);
  ProtobufMessage opset, model;
  opset.add_integer(operators_proto::kVersion, kOpset);
  model.add_integer(model_proto::kIrVersion, kIrVersion);
  model.add_bytes(model_proto::kProducer, "e2lf");
  // The fields of a message may come in any order, so its parts can simply be concatenated.
  model.add_bytes(model_proto::kGraph,
                  nodes_.bytes() + graph_name.bytes() + constants_.bytes() + inputs_.bytes() + outputs_.bytes());
  model.add_message(model_proto::kOperators, opset);
  for (const auto& [key, value] : metadata) {
    ProtobufMessage entry;
    entry.add_bytes(metadata_proto::kKey, key);
    entry.add_bytes(metadata_proto::kValue, value);
    model.add_message(model_proto::kMetadata, entry);
  }
  return model.bytes();
}

void ProtobufMessage::add_varint(uint64_t value) {
  for (; value >= 0x80; value >>= 7) bytes_.push_back(static_cast<char>((value & 0x7F) | 0x80));
  bytes_.push_back(static_cast<char>(value));
}

void ProtobufMessage::add_key(uint32_t field, uint32_t wire_type) {
  E2LF_REQUIRE(field >= 1 && field <= kMostFields, "a field's number is in 1 to 2^29 - 1");
  add_varint(uint64_t{field} << 3 | wire_type);
}

void ProtobufMessage::add_integer(uint32_t field, int64_t value) {
  add_key(field, kVarint);
  add_varint(static_cast<uint64_t>(value));
}

void ProtobufMessage::add_bytes(uint32_t field, std::string_view value) {
  add_key(field, kLengthDelimited);
  add_varint(value.size());
  bytes_ += value;
}

}  // namespace e2lf::model
