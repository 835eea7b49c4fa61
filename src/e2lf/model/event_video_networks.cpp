// SPDX-License-Identifier: MIT
#include "e2lf/model/event_video_networks.h"

#include <string>

#include "e2lf/base/text.h"

namespace e2lf::model {
namespace {

/// Appends layers, each of which reads the one before.
class Chain {
 public:
  explicit Chain(size_t input_channels) { network_.input_channels = input_channels; }

  [[nodiscard]] const std::string& last() const { return last_; }

  void conv(const std::string& name, size_t channels, size_t kernel, size_t stride = 1) {
    add({.name = name,
         .inputs = {},
         .out_channels = channels,
         .kernel = kernel,
         .stride = stride,
         .residual = {},
         .relu = true});
  }

  void cell(const std::string& name, Op op, size_t channels) {
    add({.name = name, .op = op, .inputs = {}, .out_channels = channels, .kernel = 3, .residual = {}});
  }

  void residual_block(const std::string& name, size_t channels) {
    const std::string input = last_;
    conv(name + "a", channels, 3);
    add({.name = name + "b", .inputs = {}, .out_channels = channels, .kernel = 3, .residual = input, .relu = true});
  }

  void plus(const std::string& name, const std::string& other) {
    network_.layers.push_back({.name = name, .op = Op::kAdd, .inputs = {last_, other}, .residual = {}});
    last_ = name;
  }

  void add(Layer layer) {
    layer.inputs = {last_};
    last_ = layer.name;
    network_.layers.push_back(std::move(layer));
  }

  [[nodiscard]] Network take() { return std::move(network_); }

 private:
  Network network_;
  std::string last_ = "input";
};

}  // namespace

Network firenet(size_t bins, size_t channels) {
  Chain chain(bins);
  chain.conv("head", channels, 3);
  for (const char* number : {"1", "2"}) {
    chain.cell(cat("cell", number), Op::kConvGru, channels);
    chain.residual_block(cat("block", number), channels);
  }
  chain.add({.name = "picture", .inputs = {}, .out_channels = 1, .residual = {}});
  return chain.take();
}

Network event_unet(const EventUnetOptions& options) {
  Chain chain(options.bins);
  size_t channels = options.channels;
  chain.conv("head", channels, 5);
  std::vector<std::string> skips = {chain.last()};
  for (size_t i = 0; i < options.encoders; ++i) {
    channels *= 2;
    chain.conv(cat("encoder", i), channels, 5, 2);
    chain.cell(cat("cell", i), Op::kConvLstm, channels);
    skips.push_back(chain.last());
  }
  for (size_t i = 0; i < options.blocks; ++i) chain.residual_block(cat("block", i), channels);
  for (size_t i = 0; i < options.encoders; ++i) {
    channels /= 2;
    chain.plus(cat("join", i), skips.back());
    skips.pop_back();
    chain.add({.name = cat("double", i), .op = Op::kUpsampleBilinear, .inputs = {}, .stride = 2, .residual = {}});
    chain.conv(cat("decoder", i), channels, 5);
  }
  chain.plus("join", skips.back());
  chain.add({.name = "picture", .inputs = {}, .out_channels = 1, .residual = {}});
  if (options.ends_in_sigmoid) chain.add({.name = "sigmoid", .op = Op::kSigmoid, .inputs = {}, .residual = {}});
  return chain.take();
}

}  // namespace e2lf::model
