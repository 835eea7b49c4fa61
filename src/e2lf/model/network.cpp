// SPDX-License-Identifier: MIT
#include "e2lf/model/network.h"

#include <algorithm>

#include "e2lf/base/text.h"

namespace e2lf::model {
namespace {

Layer conv(const std::string& name, const std::string& input, size_t out_channels, size_t kernel) {
  Layer layer;
  layer.name = name;
  layer.inputs = {input};
  layer.out_channels = out_channels;
  layer.kernel = kernel;
  return layer;
}

}  // namespace

bool is_cell(const Layer& layer) {
  return layer.op == Op::kConvGru || layer.op == Op::kConvLstm;
}

bool needs_whole_image(const Layer& layer) {
  return layer.op == Op::kAttention || layer.op == Op::kPositionCode;
}

bool is_recurrent(const Network& network) {
  return std::any_of(network.layers.begin(), network.layers.end(),
                     [](const Layer& layer) { return is_cell(layer) || layer.op == Op::kPrevious; });
}

Network recnet(size_t input_channels, size_t output_channels, size_t width) {
  constexpr size_t kBodyLayers = 20;
  Network network;
  network.input_channels = input_channels;
  network.layers = {conv("conv1", "input", width, 5), conv("conv2", "conv1", width, 5),
                    conv("conv3", "conv2", output_channels, 5)};
  for (size_t i = 1; i <= kBodyLayers; ++i) {
    const bool last = i == kBodyLayers;
    Layer layer = conv(cat("l", i), network.layers.back().name, last ? output_channels : width, 3);
    layer.relu = !last;
    if (last) layer.residual = "conv3";
    network.layers.push_back(std::move(layer));
  }
  return network;
}

}  // namespace e2lf::model
