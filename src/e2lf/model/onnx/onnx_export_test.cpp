// SPDX-License-Identifier: MIT
#include "e2lf/model/onnx/onnx_export.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <set>

#include "e2lf/base/text.h"

namespace e2lf::model {
namespace {

using testing::ElementsAre;

/// The fields of a message by their number, in order; numbers as text.
using Fields = std::multimap<uint64_t, std::string>;

uint64_t take_varint(std::string_view& bytes) {
  uint64_t value = 0;
  for (unsigned shift = 0;; shift += 7) {
    const auto byte = static_cast<uint8_t>(bytes.at(0));
    bytes.remove_prefix(1);
    value |= uint64_t{byte & 0x7FU} << shift;
    if (byte < 0x80) return value;
  }
}

Fields fields_of(std::string_view bytes) {
  Fields fields;
  while (!bytes.empty()) {
    const uint64_t key = take_varint(bytes), field = key >> 3;
    if ((key & 7) == 0) {
      fields.emplace(field, std::to_string(take_varint(bytes)));
      continue;
    }
    EXPECT_EQ(key & 7, 2U);
    const uint64_t size = take_varint(bytes);
    fields.emplace(field, std::string(bytes.substr(0, size)));
    bytes.remove_prefix(size);
  }
  return fields;
}

std::vector<std::string> all(const Fields& fields, uint64_t number) {
  std::vector<std::string> values;
  const auto [begin, end] = fields.equal_range(number);
  for (auto it = begin; it != end; ++it) values.push_back(it->second);
  return values;
}

std::string one(const Fields& fields, uint64_t number) {
  const auto values = all(fields, number);
  EXPECT_EQ(values.size(), 1U);
  return values.empty() ? "" : values.front();
}

/// The graph of a file; its nodes are fields 1, its constants 5, its inputs 11, its outputs 12.
Fields graph_of(const std::string& file) {
  return fields_of(one(fields_of(file), 7));
}

/// The operations in their order.
std::vector<std::string> operations(const Fields& graph) {
  std::vector<std::string> names;
  for (const std::string& node : all(graph, 1)) names.push_back(one(fields_of(node), 4));
  return names;
}

/// A model for 4 patterns with these layers and inputs, and weights of the value 1.
Model model_with(std::vector<Layer> layers, std::vector<InputGroup> input) {
  Model model;
  model.name = "tiny";
  model.num_patterns = 4;
  model.views_y = 1;
  model.views_x = 2;
  model.constants = {0.02F, 0.25F, 0.1F, 0.0F};
  model.input = std::move(input);
  model.network.input_channels = num_input_channels(model.input, model.num_patterns);
  model.network.layers = std::move(layers);
  for (const WeightShape& tensor : weight_shapes(model.network)) {
    size_t size = 1;
    for (const size_t extent : tensor.shape) size *= extent;
    model.weights[tensor.name].assign(size, 1.0F);
  }
  return model;
}

Layer conv(const std::string& name, const std::string& input, size_t channels) {
  Layer layer;
  layer.name = name;
  layer.inputs = {input};
  layer.out_channels = channels;
  layer.kernel = 3;
  return layer;
}

Layer shuffle(const std::string& name, const std::string& input, const char* op) {
  Layer layer;
  layer.name = name;
  layer.inputs = {input};
  layer.op = op;
  layer.stride = 2;
  return layer;
}

TEST(OnnxGraph, WritesTheBytesOfAFile) {
  OnnxGraph graph;
  graph.add_input("a", {"n", int64_t{3}});
  graph.add_output("b", {"n", int64_t{3}});
  graph.add_node("Mul", {"a", graph.add_constant("c", 1.0F)}, "b");
  const std::vector<std::pair<std::string, std::string>> metadata = {{"k", "v"}};
  // By the numbers of onnx.proto: each line a field with its key, its size and what it holds.
  const std::string value_type = std::string("\x0a\x0d\x08\x01\x12\x09", 6) + std::string("\x0a\x03\x12\x01n", 5) +
                                 std::string("\x0a\x02\x08\x03", 4);
  const std::string expected = std::string("\x08\x08", 2) + "\x12\x04" + "e2lf" + "\x3a\x4f" +
                               ("\x0a\x11" + std::string("\x0a\x01"
                                                         "a"
                                                         "\x0a\x01"
                                                         "c"
                                                         "\x12\x01"
                                                         "b"
                                                         "\x1a\x01"
                                                         "b"
                                                         "\x22\x03"
                                                         "Mul")) +
                               ("\x12\x01"
                                "g") +
                               std::string(
                                   "\x2a\x0b\x10\x01\x42\x01"
                                   "c"
                                   "\x4a\x04\x00\x00\x80\x3f",
                                   13) +
                               ("\x5a\x14\x0a\x01"
                                "a"
                                "\x12\x0f" +
                                value_type) +
                               ("\x62\x14\x0a\x01"
                                "b"
                                "\x12\x0f" +
                                value_type) +
                               ("\x42\x02\x10\x11") +
                               ("\x72\x06\x0a\x01"
                                "k"
                                "\x12\x01"
                                "v");
  EXPECT_EQ(graph.file("g", metadata), expected);
}

TEST(OnnxExport, TellsInputsOutputsAndMetadata) {
  Model model = model_with({conv("a", "input", 2)}, {{InputKind::kCounts, 1.0F}, {InputKind::kCamera, 1.0F}});
  model.codes = capture::Codes(4, 1, 2);
  model.codes->values = {0, 0, 0, 1, 1, 0, 1, 1};
  const auto file = onnx_file(model);
  ASSERT_TRUE(file.ok()) << file.error().text();
  const Fields graph = graph_of(*file);
  std::vector<std::string> inputs;
  for (const std::string& value : all(graph, 11)) inputs.push_back(one(fields_of(value), 1));
  EXPECT_THAT(inputs, ElementsAre("events", "traits"));
  EXPECT_EQ(one(fields_of(one(graph, 12)), 1), "views");

  std::map<std::string, std::string> metadata;
  for (const std::string& entry : all(fields_of(*file), 14)) {
    metadata[one(fields_of(entry), 1)] = one(fields_of(entry), 2);
  }
  EXPECT_EQ(metadata.at("name"), "tiny");
  EXPECT_EQ(metadata.at("view_order"), "VV_UU");
  EXPECT_EQ(Json::parse(metadata.at("event_constants")).at("tau"), 0.25);
  EXPECT_EQ(Json::parse(metadata.at("patterns")).at("patterns").at(1).at(0), "01");
  EXPECT_EQ(Json::parse(metadata.at("traits")).size(), capture::conditioning_size(4));
}

TEST(OnnxExport, PadsAndCropsOnlyWhereTheNetworkNeedsMultiples) {
  const std::vector<InputGroup> counts = {{InputKind::kCounts, 0.5F}};
  const auto plain = onnx_file(model_with({conv("a", "input", 2)}, counts));
  ASSERT_TRUE(plain.ok());
  EXPECT_THAT(operations(graph_of(*plain)), ElementsAre("Shape", "Mul", "Concat", "Conv", "Slice"));

  const auto halved = onnx_file(model_with(
      {shuffle("down", "input", Op::kPixelUnshuffle), conv("a", "down", 8), shuffle("up", "a", Op::kPixelShuffle)},
      counts));
  ASSERT_TRUE(halved.ok());
  std::vector<std::string> expected = {"Shape", "Neg", "Mod", "Add"};
  for (int axis = 0; axis < 2; ++axis) {
    for (const char* mirror :
         {"Gather", "Mul", "Gather", "Squeeze", "Squeeze", "Squeeze", "Range", "Mod", "Sub", "Sub", "Min", "Gather"}) {
      expected.emplace_back(mirror);
    }
  }
  for (const char* layer : {"Mul", "Concat", "SpaceToDepth", "Gather", "Conv", "DepthToSpace", "Slice"}) {
    expected.emplace_back(layer);
  }
  EXPECT_EQ(operations(graph_of(*halved)), expected);
}

TEST(OnnxExport, GivesEveryTensorANameOfItsOwn) {
  // Layers may be called as the tensors of others, and as the graph's own.
  std::vector<Layer> layers = {conv("events", "input", 2), conv("views", "events", 2), conv("a", "views", 2),
                               conv("a.weight", "a", 2)};
  layers[2].relu = true;
  layers[2].residual = "events";
  layers[3].residual = "a";
  const auto file = onnx_file(model_with(layers, {{InputKind::kCounts, 1.0F},
                                                  {InputKind::kIntensity, 1.0F},
                                                  {InputKind::kCumulative, 1.0F},
                                                  {InputKind::kLevel, 1.0F},
                                                  {InputKind::kCounts, 2.0F}}));
  ASSERT_TRUE(file.ok());
  const Fields graph = graph_of(*file);
  std::multiset<std::string> names = {"events"};
  for (const std::string& node : all(graph, 1)) {
    for (const std::string& input : all(fields_of(node), 1)) {
      const auto constants = all(graph, 5);
      const bool is_constant = std::any_of(constants.begin(), constants.end(), [&](const std::string& constant) {
        return one(fields_of(constant), 8) == input;
      });
      EXPECT_TRUE(is_constant || names.contains(input)) << input << " is read before it is made";
    }
    names.insert(one(fields_of(node), 2));
  }
  for (const std::string& constant : all(graph, 5)) names.insert(one(fields_of(constant), 8));
  for (const std::string& name : names) EXPECT_EQ(names.count(name), 1U) << name;
}

TEST(OnnxExport, RefusesAModelThatDoesNotFit) {
  Model model = model_with({conv("a", "input", 2)}, {{InputKind::kCounts, 1.0F}});
  model.weights.at("a.bias").pop_back();
  const auto file = onnx_file(model);
  ASSERT_FALSE(file.ok());
  EXPECT_EQ(file.error().code, ErrorCode::kShape);
}

}  // namespace
}  // namespace e2lf::model
