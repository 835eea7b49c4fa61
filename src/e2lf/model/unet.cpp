// SPDX-License-Identifier: MIT
#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/model/network.h"

namespace e2lf::model {
namespace {

// These functions append layers to a network and return the name of the last one, so that they can be chained.

std::string add(Network& network, Layer layer) {
  network.layers.push_back(std::move(layer));
  return network.layers.back().name;
}

std::string add_conv(Network& network, const std::string& name, const std::string& input, size_t channels,
                     size_t kernel = 3, size_t stride = 1) {
  return add(network, {.name = name, .inputs = {input}, .out_channels = channels, .kernel = kernel, .stride = stride});
}

/// Doubles the resolution by a transposed convolution.
std::string add_doubling(Network& network, const std::string& name, const std::string& input, size_t channels) {
  return add(
      network,
      {.name = name, .op = Op::kConvTransposed, .inputs = {input}, .out_channels = channels, .kernel = 2, .stride = 2});
}

/// Adds `count` blocks of conv-ReLU-conv with skip connections.
std::string add_residual_blocks(Network& network, const std::string& name, std::string input, size_t channels,
                                size_t count) {
  for (size_t i = 0; i < count; ++i) {
    const std::string inner = add_conv(network, cat(name, "_", i, "a"), input, channels);
    network.layers.back().relu = true;
    const std::string outer = add_conv(network, cat(name, "_", i, "b"), inner, channels);
    network.layers.back().residual = input;
    input = outer;
  }
  return input;
}

/// Appends the end of the network at full resolution.
void add_head(Network& network, std::string x, const UnetOptions& options) {
  add_conv(network, "head", x, 4 * options.head_width);
  network.layers.back().relu = true;
  x = add(network, {.name = "shuffle", .op = Op::kPixelShuffle, .inputs = {"head"}, .stride = 2});
  if (options.head_blocks > 0) {
    const std::string detail = add_conv(network, "detail", "input", options.head_width);
    x = add(network, {.name = "head_join", .op = Op::kAdd, .inputs = {x, detail}});
    x = add_residual_blocks(network, "full", x, options.head_width, options.head_blocks);
  }
  const std::string skip = add_conv(network, "skip", "input", options.output_channels, 1);
  add_conv(network, "output", x, options.output_channels);
  network.layers.back().residual = skip;
}

}  // namespace

Network unet(const UnetOptions& options) {
  const auto& widths = options.widths;
  E2LF_REQUIRE(!widths.empty() && widths.size() == options.blocks.size(), "one width and one block count per level");
  Network network;
  network.input_channels = options.input_channels;

  std::string x =
      add(network, {.name = "unshuffle", .op = Op::kPixelUnshuffle, .inputs = {"input"}, .kernel = 1, .stride = 2});
  x = add_conv(network, "stem", x, widths[0]);
  std::vector<std::string> skips;
  const size_t last = widths.size() - 1;
  for (size_t level = 0; level < last; ++level) {
    x = add_residual_blocks(network, cat("down", level), x, widths[level], options.blocks[level]);
    skips.push_back(x);
    x = add_conv(network, cat("down", level, "_half"), x, widths[level + 1], 2, 2);
  }
  x = add_residual_blocks(network, "middle", x, widths[last], options.blocks[last]);
  for (size_t level = last; level-- > 0;) {
    x = add_doubling(network, cat("up", level, "_double"), x, widths[level]);
    x = add(network, {.name = cat("up", level, "_join"), .op = Op::kAdd, .inputs = {x, skips[level]}});
    x = add_residual_blocks(network, cat("up", level), x, widths[level], options.blocks[level]);
  }

  if (options.head_width == 0) {
    add_doubling(network, "output", x, options.output_channels);
  } else {
    add_head(network, x, options);
  }
  return network;
}

}  // namespace e2lf::model
