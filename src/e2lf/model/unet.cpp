// SPDX-License-Identifier: MIT
#include <utility>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/model/layer_list.h"

namespace e2lf::model {

std::string LayerList::add(Layer layer) {
  network.layers.push_back(std::move(layer));
  return network.layers.back().name;
}

std::string LayerList::conv(const std::string& name, const std::string& input, size_t channels, size_t kernel,
                            size_t stride) {
  return add({.name = name, .inputs = {input}, .out_channels = channels, .kernel = kernel, .stride = stride});
}

std::string LayerList::doubling(const std::string& name, const std::string& input, size_t channels) {
  conv(name, input, channels, 2, 2);
  network.layers.back().op = Op::kConvTransposed;
  return name;
}

std::string LayerList::blocks(const std::string& name, std::string input, size_t channels, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    const std::string inner = conv(cat(name, "_", i, "a"), input, channels);
    network.layers.back().relu = true;
    const std::string outer = conv(cat(name, "_", i, "b"), inner, channels);
    network.layers.back().residual = input;
    input = outer;
  }
  return input;
}

std::string LayerList::levels(const std::string& input, const std::vector<size_t>& widths,
                              const std::vector<size_t>& blocks_of,
                              const std::function<std::string(const std::string& half)>& after_half) {
  const auto add_blocks = [&](const std::string& name, const std::string& x, size_t level) {
    return blocks(name, x, widths[level], blocks_of.empty() ? 1 : blocks_of[level]);
  };
  std::string x = input;
  std::vector<std::string> skips;
  const size_t last = widths.size() - 1;
  for (size_t level = 0; level < last; ++level) {
    x = add_blocks(cat("down", level), x, level);
    skips.push_back(x);
    x = conv(cat("down", level, "_half"), x, widths[level + 1], 2, 2);
    if (level == 0 && after_half) x = after_half(x);
  }
  x = add_blocks("middle", x, last);
  for (size_t level = last; level-- > 0;) {
    x = doubling(cat("up", level, "_double"), x, widths[level]);
    x = add({.name = cat("up", level, "_join"), .op = Op::kAdd, .inputs = {x, skips[level]}});
    x = add_blocks(cat("up", level), x, level);
  }
  return x;
}

Network unet(const UnetOptions& options) {
  E2LF_REQUIRE(!options.widths.empty() && options.widths.size() == options.blocks.size(),
               "one width and one block count per level");
  Network network{options.input_channels, {}};
  LayerList layers{network};
  layers.add({.name = "unshuffle", .op = Op::kPixelUnshuffle, .inputs = {"input"}, .stride = 2});
  std::string x = layers.levels(layers.conv("stem", "unshuffle", options.widths[0]), options.widths, options.blocks);
  if (options.head_width == 0) {
    layers.doubling("output", x, options.output_channels);
    return network;
  }
  // The end of the network at full resolution.
  layers.conv("head", x, 4 * options.head_width);
  network.layers.back().relu = true;
  x = layers.add({.name = "shuffle", .op = Op::kPixelShuffle, .inputs = {"head"}, .stride = 2});
  if (options.head_blocks > 0) {
    const std::string detail = layers.conv("detail", "input", options.head_width);
    x = layers.add({.name = "head_join", .op = Op::kAdd, .inputs = {x, detail}});
    x = layers.blocks("full", x, options.head_width, options.head_blocks);
  }
  const std::string skip = layers.conv("skip", "input", options.output_channels, 1);
  layers.conv("output", x, options.output_channels);
  network.layers.back().residual = skip;
  return network;
}

}  // namespace e2lf::model
