// SPDX-License-Identifier: MIT
#include "e2lf/learn/network/levels.h"

#include <utility>

#include "e2lf/base/text.h"

namespace e2lf::learn {

std::string LayerList::add(model::Layer layer) {
  network.layers.push_back(std::move(layer));
  return network.layers.back().name;
}

std::string LayerList::conv(const std::string& name, const std::string& input, size_t channels, size_t kernel,
                            size_t stride) {
  return add({.name = name, .inputs = {input}, .out_channels = channels, .kernel = kernel, .stride = stride});
}

std::string LayerList::block(const std::string& name, const std::string& input, size_t channels) {
  const std::string inner = conv(name + "_0a", input, channels, 3);
  network.layers.back().relu = true;
  const std::string outer = conv(name + "_0b", inner, channels, 3);
  network.layers.back().residual = input;
  return outer;
}

std::string add_levels(LayerList& layers, const std::string& input, const std::vector<size_t>& widths,
                       const std::function<std::string(const std::string& half)>& after_half) {
  std::string x = input;
  std::vector<std::string> skips;
  const size_t last = widths.size() - 1;
  for (size_t level = 0; level < last; ++level) {
    x = layers.block(cat("down", level), x, widths[level]);
    skips.push_back(x);
    x = layers.conv(cat("down", level, "_half"), x, widths[level + 1], 2, 2);
    if (level == 0 && after_half) x = after_half(x);
  }
  x = layers.block("middle", x, widths[last]);
  for (size_t level = last; level-- > 0;) {
    x = layers.conv(cat("up", level, "_double"), x, widths[level], 2, 2);
    layers.network.layers.back().op = model::Op::kConvTransposed;
    x = layers.add({.name = cat("up", level, "_join"), .op = model::Op::kAdd, .inputs = {x, skips[level]}});
    x = layers.block(cat("up", level), x, widths[level]);
  }
  return x;
}

}  // namespace e2lf::learn
