// SPDX-License-Identifier: MIT
#include <algorithm>
#include <functional>
#include <map>
#include <numeric>

#include "e2lf/model/network.h"

namespace e2lf::model {
namespace {

bool has_weights(const Layer& layer) {
  return layer.op == Op::kConv || layer.op == Op::kConvTransposed;
}

size_t product(const std::vector<size_t>& shape) {
  return std::accumulate(shape.begin(), shape.end(), size_t{1}, std::multiplies<>());
}

/// Every tensor's shape by name, the input's included.
std::map<std::string, LayerShape> shapes_by_name(const Network& network) {
  const std::vector<LayerShape> shapes = infer_shapes(network).value();
  std::map<std::string, LayerShape> by_name = {{"input", {network.input_channels, 1}}};
  for (size_t i = 0; i < shapes.size(); ++i) by_name.emplace(network.layers[i].name, shapes[i]);
  return by_name;
}

}  // namespace

std::vector<WeightShape> weight_shapes(const Network& network) {
  const auto shapes = shapes_by_name(network);
  std::vector<WeightShape> result;
  for (const Layer& layer : network.layers) {
    if (!has_weights(layer)) continue;
    const size_t in = shapes.at(layer.inputs.front()).channels;
    const size_t out = layer.out_channels;
    const bool transposed = layer.op == Op::kConvTransposed;
    result.push_back(
        {layer.name + ".weight", {transposed ? in : out, transposed ? out : in, layer.kernel, layer.kernel}});
    result.push_back({layer.name + ".bias", {out}});
  }
  return result;
}

double macs_per_pixel(const Network& network) {
  const auto shapes = shapes_by_name(network);
  double sum = 0.0;
  for (const Layer& layer : network.layers) {
    if (!has_weights(layer)) continue;
    const LayerShape input = shapes.at(layer.inputs.front());
    // A transposed convolution visits all its weights once per pixel of its input, a plain one per pixel of its output.
    const size_t scale = layer.op == Op::kConv ? shapes.at(layer.name).scale : input.scale;
    const size_t weights = input.channels * layer.out_channels * layer.kernel * layer.kernel;
    sum += static_cast<double>(weights) / static_cast<double>(scale * scale);
  }
  return sum;
}

size_t num_parameters(const Network& network) {
  size_t sum = 0;
  for (const WeightShape& tensor : weight_shapes(network)) sum += product(tensor.shape);
  return sum;
}

size_t receptive_radius(const Network& network) {
  const auto shapes = shapes_by_name(network);
  // A pixel at scale s stands for a block of s input pixels; the radius is what it sees beyond that block.
  std::map<std::string, size_t> radius = {{"input", 0}};
  for (const Layer& layer : network.layers) {
    size_t reach = 0;
    for (const std::string& input : layer.inputs) reach = std::max(reach, radius.at(input));
    const size_t scale_in = shapes.at(layer.inputs.front()).scale;
    const size_t scale_out = shapes.at(layer.name).scale;
    if (scale_out < scale_in) {
      reach += scale_in - scale_out;  // the rest of the coarse block, for the finest pixel at its edge
    } else if (layer.op == Op::kConv && layer.stride == 1) {
      reach += layer.kernel / 2 * scale_in;
    }
    if (!layer.residual.empty()) reach = std::max(reach, radius.at(layer.residual));
    radius[layer.name] = reach;
  }
  return radius.at(network.layers.back().name);
}

}  // namespace e2lf::model
