// SPDX-License-Identifier: MIT
#include "e2lf/model/unet.h"

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"

namespace e2lf::model {
namespace {

/// Appends layers to a network and returns the name of each, so that they can be chained.
class Builder {
 public:
  explicit Builder(Network& network) : network_(network) {}

  std::string conv(const std::string& name, const std::string& input, size_t channels, size_t kernel = 3,
                   size_t stride = 1) {
    return add({.name = name, .inputs = {input}, .out_channels = channels, .kernel = kernel, .stride = stride});
  }

  /// Adds `count` blocks of conv-ReLU-conv with skip connections.
  std::string residual_blocks(const std::string& name, std::string input, size_t channels, size_t count) {
    for (size_t i = 0; i < count; ++i) {
      const std::string inner = conv(cat(name, "_", i, "a"), input, channels);
      last().relu = true;
      const std::string outer = conv(cat(name, "_", i, "b"), inner, channels);
      last().residual = input;
      input = outer;
    }
    return input;
  }

  Layer& last() { return network_.layers.back(); }

  std::string add(Layer layer) {
    network_.layers.push_back(std::move(layer));
    return network_.layers.back().name;
  }

 private:
  Network& network_;
};

/// Appends the end of the network at full resolution.
void add_head(Builder& build, std::string x, const UnetOptions& options) {
  build.conv("head", x, 4 * options.head_width);
  build.last().relu = true;
  x = build.add({.name = "shuffle", .op = Op::kPixelShuffle, .inputs = {"head"}, .stride = 2});
  if (options.head_blocks > 0) {
    const std::string detail = build.conv("detail", "input", options.head_width);
    x = build.add({.name = "head_join", .op = Op::kAdd, .inputs = {x, detail}});
    x = build.residual_blocks("full", x, options.head_width, options.head_blocks);
  }
  const std::string skip = build.conv("skip", "input", options.output_channels, 1);
  build.conv("output", x, options.output_channels);
  build.last().residual = skip;
}

/// Appends the step from half resolution to the output, without any convolution at full resolution.
void add_light_head(Builder& build, const std::string& x, const UnetOptions& options) {
  build.add({.name = "output",
             .op = Op::kConvTransposed,
             .inputs = {x},
             .out_channels = options.output_channels,
             .kernel = 2,
             .stride = 2});
}

}  // namespace

Network unet(const UnetOptions& options) {
  const auto& widths = options.widths;
  E2LF_REQUIRE(!widths.empty() && widths.size() == options.blocks.size(), "one width and one block count per level");
  Network network;
  network.input_channels = options.input_channels;
  Builder build(network);

  std::string x =
      build.add({.name = "unshuffle", .op = Op::kPixelUnshuffle, .inputs = {"input"}, .kernel = 1, .stride = 2});
  x = build.conv("stem", x, widths[0]);
  std::vector<std::string> skips;
  const size_t last = widths.size() - 1;
  for (size_t level = 0; level < last; ++level) {
    x = build.residual_blocks(cat("down", level), x, widths[level], options.blocks[level]);
    skips.push_back(x);
    x = build.conv(cat("down", level, "_half"), x, widths[level + 1], 2, 2);
  }
  x = build.residual_blocks("middle", x, widths[last], options.blocks[last]);
  for (size_t level = last; level-- > 0;) {
    x = build.add({.name = cat("up", level, "_double"),
                   .op = Op::kConvTransposed,
                   .inputs = {x},
                   .out_channels = widths[level],
                   .kernel = 2,
                   .stride = 2});
    x = build.add({.name = cat("up", level, "_join"), .op = Op::kAdd, .inputs = {x, skips[level]}});
    x = build.residual_blocks(cat("up", level), x, widths[level], options.blocks[level]);
  }

  if (options.head_width == 0) {
    add_light_head(build, x, options);
  } else {
    add_head(build, x, options);
  }
  return network;
}

}  // namespace e2lf::model
