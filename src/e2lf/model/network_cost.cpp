// SPDX-License-Identifier: MIT
// Counts the operations and parameters of a network; declared in network.h.
#include <algorithm>
#include <functional>
#include <map>
#include <numeric>

#include "e2lf/model/network.h"

namespace e2lf::model {
namespace {

/// A convolution of a layer: the shape of its weights, and the number of input pixels along an axis per pixel at which
/// it is evaluated.
struct ConvCost {
  std::string name;
  size_t out = 0, in = 0;  ///< as stored, i.e. swapped for transposed convolutions
  size_t bias = 0;
  size_t kernel = 1;
  size_t scale = 1;
};

/// Returns the convolutions of a layer that has `in` input channels at scale `scale_in` and its output at `scale_out`.
std::vector<ConvCost> convolutions(const Layer& layer, size_t in, size_t scale_in, size_t scale_out) {
  const size_t out = layer.out_channels, kernel = layer.kernel;
  switch (layer.op) {
    case Op::kConv:
      return {{layer.name, out, in, out, kernel, scale_out}};
    case Op::kConvTransposed:
      // A transposed convolution applies all of its weights once per input pixel, not per output pixel.
      return {{layer.name, in, out, out, kernel, scale_in}};
    case Op::kConvGru:
      return {{layer.name + ".gates", 2 * out, in + out, 2 * out, kernel, scale_out},
              {layer.name + ".candidate", out, in + out, out, kernel, scale_out}};
    case Op::kConvLstm:
      return {{layer.name + ".gates", 4 * out, in + out, 4 * out, kernel, scale_out}};
    case Op::kPixelUnshuffle:
    case Op::kPixelShuffle:
    case Op::kUpsample:
    case Op::kUpsampleBilinear:
    case Op::kAdd:
    case Op::kMean:
    case Op::kConcat:
    case Op::kSigmoid:
    case Op::kTanh:
    case Op::kDynamicFilter:
    case Op::kLayerNorm:
    case Op::kPositionCode:
    case Op::kAttention:
    case Op::kPrevious:
      break;
  }
  return {};
}

size_t product(const std::vector<size_t>& shape) {
  return std::accumulate(shape.begin(), shape.end(), size_t{1}, std::multiplies<>());
}

/// Returns the shapes of all tensors by name, including the input.
std::map<std::string, LayerShape> shapes_by_name(const Network& network) {
  const std::vector<LayerShape> shapes = infer_shapes(network).value();
  std::map<std::string, LayerShape> by_name = {{"input", {network.input_channels, 1}}};
  for (size_t i = 0; i < shapes.size(); ++i) by_name.emplace(network.layers[i].name, shapes[i]);
  return by_name;
}

std::vector<ConvCost> convolutions(const Layer& layer, const std::map<std::string, LayerShape>& shapes) {
  if (layer.inputs.empty()) return {};
  const LayerShape input = shapes.at(layer.inputs.front());
  return convolutions(layer, input.channels, input.scale, shapes.at(layer.name).scale);
}

}  // namespace

std::vector<WeightShape> weight_shapes(const Network& network) {
  std::vector<WeightShape> result;
  const auto shapes = shapes_by_name(network);
  for (const Layer& layer : network.layers) {
    const size_t channels = shapes.at(layer.name).channels;
    if (layer.op == Op::kLayerNorm) {
      result.push_back({layer.name + ".weight", {channels}});
      result.push_back({layer.name + ".bias", {channels}});
    }
    for (const ConvCost& conv : convolutions(layer, shapes)) {
      result.push_back({conv.name + ".weight", {conv.out, conv.in, conv.kernel, conv.kernel}});
      result.push_back({conv.name + ".bias", {conv.bias}});
    }
  }
  return result;
}

double macs_per_pixel(const Network& network) {
  double sum = 0.0;
  const auto shapes = shapes_by_name(network);
  for (const Layer& layer : network.layers) {
    for (const ConvCost& conv : convolutions(layer, shapes)) {
      const size_t weights = conv.in * conv.out * conv.kernel * conv.kernel;
      sum += static_cast<double>(weights) / static_cast<double>(conv.scale * conv.scale);
    }
    if (layer.op != Op::kDynamicFilter) continue;
    const LayerShape output = shapes.at(layer.name);
    const size_t products = output.channels * layer.kernel * layer.kernel;
    sum += static_cast<double>(products) / static_cast<double>(output.scale * output.scale);
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
  // A pixel at scale s represents a block of s input pixels. The radius counts the context beyond that block.
  std::map<std::string, size_t> radius = {{"input", 0}};
  for (const Layer& layer : network.layers) {
    if (layer.op == Op::kPrevious) {
      radius[layer.name] = 0;  // it depends on nothing in the same frame
      continue;
    }
    if (needs_whole_image(layer)) return kWholeImage;
    size_t reach = 0;
    for (const std::string& input : layer.inputs) reach = std::max(reach, radius.at(input));
    const size_t scale_in = shapes.at(layer.inputs.front()).scale;
    const size_t scale_out = shapes.at(layer.name).scale;
    if (scale_out < scale_in) {
      reach += scale_in - scale_out;  // the rest of the coarse block, for the finest pixel at its edge
      if (layer.op == Op::kUpsampleBilinear) reach += scale_in;
    } else if (layer.op == Op::kConv && layer.kernel != layer.stride) {
      reach += layer.kernel / 2 * scale_in + (scale_out - scale_in);
    } else if (layer.op == Op::kDynamicFilter) {
      reach += layer.kernel / 2 * scale_in;
    } else if (is_cell(layer)) {
      reach += (layer.op == Op::kConvGru ? 2 : 1) * (layer.kernel / 2) * scale_in;
    }
    if (!layer.residual.empty()) reach = std::max(reach, radius.at(layer.residual));
    radius[layer.name] = reach;
  }
  return radius.at(network.layers.back().name);
}

}  // namespace e2lf::model
