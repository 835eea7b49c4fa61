// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "e2lf/base/rng.h"
#include "e2lf/model/model.h"

namespace e2lf::engine {

/// A named network for tests.
struct TestNetwork {
  std::string name;
  model::Network network;
  size_t multiple = 1;  ///< of height and width
};

inline std::vector<float> random_values(size_t count, uint64_t seed, float scale = 1.0F) {
  const CounterRng rng(seed, 0);
  std::vector<float> values(count);
  for (size_t i = 0; i < count; ++i) values[i] = (2.0F * rng.uniform(i) - 1.0F) * scale;
  return values;
}

inline model::Layer conv(const std::string& name, const std::string& input, size_t out, size_t kernel, bool relu = true,
                         const std::string& residual = "", size_t stride = 1) {
  model::Layer layer;
  layer.name = name;
  layer.inputs = {input};
  layer.out_channels = out;
  layer.kernel = kernel;
  layer.stride = stride;
  layer.relu = relu;
  layer.residual = residual;
  return layer;
}

inline model::Layer reshape(const std::string& name, const std::string& op, std::vector<std::string> inputs,
                            size_t stride = 1, bool relu = false) {
  model::Layer layer;
  layer.name = name;
  layer.op = op;
  layer.inputs = std::move(inputs);
  layer.stride = stride;
  layer.relu = relu;
  return layer;
}

inline model::Layer transposed(const std::string& name, const std::string& input, size_t out, size_t stride) {
  model::Layer layer = conv(name, input, out, stride, true, "", stride);
  layer.op = model::Op::kConvTransposed;
  return layer;
}

/// Returns plain and residual networks, the architecture of the paper with few channels, and multi-scale networks with
/// every operation of model::Op.
inline std::vector<TestNetwork> test_networks() {
  using model::Op;
  std::vector<TestNetwork> list;
  list.push_back({"plain", {5, {conv("a", "input", 20, 3), conv("b", "a", 33, 1), conv("c", "b", 16, 7, false)}}, 1});
  list.push_back({"residual",
                  {16,
                   {conv("a", "input", 80, 3), conv("b", "a", 80, 3), conv("c", "b", 80, 3, true, "a"),
                    conv("d", "c", 16, 3, false, "input")}},
                  1});
  model::Network recnet{
      3, {conv("f1", "input", 24, 5, false), conv("f2", "f1", 24, 5, false), conv("f3", "f2", 64, 5, false)}};
  for (int i = 1; i <= 3; ++i) {
    recnet.layers.push_back(conv("l" + std::to_string(i), recnet.layers.back().name, 64, 3));
  }
  recnet.layers.push_back(conv("l4", "l3", 64, 3, false, "f3"));
  list.push_back({"recnet", recnet, 1});
  list.push_back(
      {"unet",
       {3,
        {reshape("u", Op::kPixelUnshuffle, {"input"}, 2), conv("e1", "u", 32, 3), conv("d1", "e1", 40, 2, true, "", 2),
         conv("e2", "d1", 40, 3, true, "d1"), transposed("t1", "e2", 32, 2), reshape("cat", Op::kConcat, {"t1", "e1"}),
         conv("g", "cat", 32, 3), reshape("sum", Op::kAdd, {"g", "e1"}, 1, true), conv("h", "sum", 24, 3, false),
         reshape("out", Op::kPixelShuffle, {"h"}, 2)}},
       4});
  list.push_back(
      {"upsample",
       {4,
        {conv("d", "input", 18, 3, true, "", 3), conv("e", "d", 18, 5), reshape("up", Op::kUpsample, {"e"}, 3),
         reshape("cat", Op::kConcat, {"input", "up"}, 1, true), conv("out", "cat", 7, 3)}},
       3});
  // Sums that convolutions can compute themselves, of a convolution and another tensor, in both orders.
  model::Layer up = transposed("up", "half", 32, 2);
  up.relu = false;
  list.push_back(
      {"sums",
       {5,
        {reshape("u", Op::kPixelUnshuffle, {"input"}, 2), conv("a", "u", 32, 3), conv("half", "a", 40, 2, true, "", 2),
         up, reshape("first", Op::kAdd, {"up", "a"}, 1, true), conv("b", "first", 32, 3, false),
         conv("c", "first", 32, 1, false), reshape("second", Op::kAdd, {"b", "c"}), conv("d", "second", 36, 3),
         reshape("shuffle", Op::kPixelShuffle, {"d"}, 2), conv("e", "input", 9, 3, false),
         reshape("third", Op::kAdd, {"shuffle", "e"}), conv("out", "third", 7, 3, false)}},
       4});
  return list;
}

/// Returns weights that preserve the magnitude of values from layer to layer, and biases that are not negligible.
inline model::Weights random_weights(const model::Network& network, uint64_t seed) {
  model::Weights weights;
  for (const model::WeightShape& tensor : model::weight_shapes(network)) {
    const std::vector<size_t>& shape = tensor.shape;
    if (shape.size() == 1) {
      weights[tensor.name] = random_values(shape[0], ++seed, 0.3F);
      continue;
    }
    const std::string layer = tensor.name.substr(0, tensor.name.rfind('.'));
    const bool is_transposed = std::any_of(network.layers.begin(), network.layers.end(), [&](const auto& each) {
      return each.name == layer && each.op == model::Op::kConvTransposed;
    });
    const size_t summed = is_transposed ? shape[0] : shape[1] * shape[2] * shape[3];
    const float scale = std::sqrt(4.0F / static_cast<float>(summed));
    weights[tensor.name] = random_values(shape[0] * shape[1] * shape[2] * shape[3], ++seed, scale);
  }
  return weights;
}

}  // namespace e2lf::engine
