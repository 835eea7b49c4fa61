// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/video/operations.h"

/// Networks for frames without weights, for tests and benchmarks.
namespace e2lf::video {

/// The sizes of the recurrent U-Net of E2VID.
struct EventUnetOptions {
  size_t bins = 5;
  size_t channels = 32;  ///< channels of the head; each encoder doubles them
  size_t encoders = 3, blocks = 2;
  bool ends_in_sigmoid = false;
};

/// The sizes of ET-Net.
struct EventTransformerOptions {
  size_t bins = 5;
  size_t channels = 32;  ///< channels of the head; each encoder doubles them
  size_t encoders = 3;
  size_t self_layers = 3, cross_layers = 2, heads = 8;  ///< per scale of the transformers
  size_t wide = 1024;                                   ///< hidden channels of the feed-forward layers
};

namespace network_parts {

using model::Layer, model::Network;

/// Appends layers, each of which reads the previous one.
class Chain {
 public:
  explicit Chain(size_t input_channels) {
    add_operations();
    network_.input_channels = input_channels;
  }

  [[nodiscard]] const std::string& last() const { return last_; }

  void conv(const std::string& name, size_t channels, size_t kernel, size_t stride = 1) {
    add({.name = name, .inputs = {}, .out_channels = channels, .kernel = kernel, .stride = stride, .relu = true});
  }

  void cell(const std::string& name, const char* op, size_t channels) {
    add({.name = name, .op = op, .inputs = {}, .out_channels = channels, .kernel = 3});
  }

  void residual_block(const std::string& name, size_t channels) {
    const std::string input = last_;
    conv(name + "a", channels, 3);
    add({.name = name + "b", .inputs = {}, .out_channels = channels, .kernel = 3, .residual = input, .relu = true});
  }

  void plus(const std::string& name, const std::string& other) {
    network_.layers.push_back({.name = name, .op = VideoOp::kAdd, .inputs = {last_, other}});
    last_ = name;
  }

  void add(Layer layer) {
    layer.inputs = {last_};
    put(std::move(layer));
  }

  /// Appends a layer that names its inputs itself.
  void put(Layer layer) {
    last_ = layer.name;
    network_.layers.push_back(std::move(layer));
  }

  [[nodiscard]] Network take() { return std::move(network_); }

 private:
  Network network_;
  std::string last_ = "input";
};

/// Adds the head and the encoders. Returns the tensors for the skip connections.
inline std::vector<std::string> encode(Chain& chain, size_t channels, size_t encoders) {
  chain.conv("head", channels, 5);
  std::vector<std::string> skips = {chain.last()};
  for (size_t i = 0; i < encoders; ++i) {
    channels *= 2;
    chain.conv(cat("encoder", i), channels, 5, 2);
    chain.cell(cat("cell", i), VideoOp::kConvLstm, channels);
    skips.push_back(chain.last());
  }
  return skips;
}

/// Adds the decoders and the output convolution.
inline void decode(Chain& chain, size_t channels, std::vector<std::string> skips) {
  for (size_t i = 0; skips.size() > 1; ++i) {
    channels /= 2;
    chain.plus(cat("join", i), skips.back());
    skips.pop_back();
    chain.add({.name = cat("double", i), .op = VideoOp::kUpsampleBilinear, .inputs = {}, .stride = 2});
    chain.conv(cat("decoder", i), channels, 5);
  }
  chain.plus("join", skips.back());
  chain.add({.name = "picture", .inputs = {}, .out_channels = 1});
}

/// Adds the transformers of ET-Net, which follow the encoders.
class Transformers {
 public:
  Transformers(Chain& chain, const EventTransformerOptions& options)
      : chain_(chain), options_(options), channels_(options.channels << options.encoders) {}

  void add(const std::vector<std::string>& skips) {
    std::vector<std::string> maps;
    for (size_t scale = 0; scale < options_.encoders; ++scale) {
      encode_scale(scale, skips[options_.encoders - scale]);
      maps.push_back(chain_.last());
    }
    for (size_t scale = 0; scale < options_.encoders; ++scale) {
      relate(scale, maps[scale], maps[scale == 0 ? 0 : scale - 1]);
      maps.push_back(chain_.last());
    }
    chain_.put({.name = "mean", .op = VideoOp::kMean, .inputs = maps});
  }

 private:
  void encode_scale(size_t scale, const std::string& input) {
    std::string x = input;
    if (scale > 0) {
      const size_t size = size_t{1} << scale;
      x = cat("split", scale);
      chain_.put({.name = x, .inputs = {input}, .out_channels = channels_, .kernel = size, .stride = size});
    }
    chain_.put({.name = cat("place", scale), .op = VideoOp::kPositionCode, .inputs = {x}});
    for (size_t i = 0; i < options_.self_layers; ++i) {
      const std::string name = cat("self", scale, "_", i), last = chain_.last();
      look_around(name, last);
      feed_forward(name, "_norm2");
    }
  }

  void relate(size_t scale, const std::string& target, const std::string& memory) {
    std::string x = target;
    for (size_t i = 0; i < options_.cross_layers; ++i) {
      const std::string name = cat("cross", scale, "_", i);
      look_around(name, x);
      norm(name + "_norm21", name + "_self");
      norm(name + "_norm22", memory);
      attend(name + "_cross", name + "_norm21", name + "_norm22", name + "_self");
      feed_forward(name, "_norm3");
      x = name;
    }
  }

  void norm(const std::string& name, const std::string& input) {
    chain_.put({.name = name, .op = VideoOp::kLayerNorm, .inputs = {input}});
  }

  void linear(const std::string& name, const std::string& input, size_t channels, const std::string& sum = "") {
    chain_.put({.name = name, .inputs = {input}, .out_channels = channels, .residual = sum});
  }

  void look_around(const std::string& name, const std::string& x) {
    norm(name + "_norm1", x);
    attend(name + "_self", name + "_norm1", name + "_norm1", x);
  }

  void attend(const std::string& name, const std::string& queries, const std::string& memory, const std::string& sum) {
    const std::vector<std::string> parts = {name + "_query", name + "_key", name + "_value"};
    for (const std::string& part : parts) linear(part, part == parts[0] ? queries : memory, channels_);
    chain_.put({.name = name + "_look",
                .op = VideoOp::kAttention,
                .inputs = parts,
                .attributes = {{"heads", {static_cast<double>(options_.heads)}}}});
    linear(name, name + "_look", channels_, sum);
  }

  void feed_forward(const std::string& name, const char* norm_name) {
    const std::string x = chain_.last();
    norm(name + norm_name, x);
    chain_.put({.name = name + "_wide", .inputs = {name + norm_name}, .out_channels = options_.wide, .relu = true});
    linear(name, name + "_wide", channels_, x);
  }

  Chain& chain_;
  const EventTransformerOptions& options_;
  size_t channels_;
};

}  // namespace network_parts

using namespace network_parts;

/// Builds FireNet (Scheerlinck et al., WACV 2020), which is also the architecture of FireNet+: a 3x3 convolution, two
/// pairs of a GRU and a residual block, and a 1x1 convolution to one channel, all at full resolution. It has 37,777
/// parameters.
inline model::Network firenet(size_t bins = 5, size_t channels = 16) {
  Chain chain(bins);
  chain.conv("head", channels, 3);
  for (const char* number : {"1", "2"}) {
    chain.cell(cat("cell", number), VideoOp::kConvGru, channels);
    chain.residual_block(cat("block", number), channels);
  }
  chain.add({.name = "picture", .inputs = {}, .out_channels = 1});
  return chain.take();
}

/// Builds the recurrent U-Net of E2VID (Rebecq et al., TPAMI 2021), E2VID+ and SSL-E2VID, with batch normalisation
/// folded in: a 5x5 convolution; encoders, each with a strided 5x5 convolution and an LSTM; residual blocks; decoders,
/// each with bilinear upsampling and a 5x5 convolution, before which the output of the corresponding encoder is added;
/// and a 1x1 convolution to one channel.
inline model::Network event_unet(const EventUnetOptions& options = {}) {
  Chain chain(options.bins);
  std::vector<std::string> skips = encode(chain, options.channels, options.encoders);
  const size_t channels = options.channels << options.encoders;
  for (size_t i = 0; i < options.blocks; ++i) chain.residual_block(cat("block", i), channels);
  decode(chain, channels, std::move(skips));
  if (options.ends_in_sigmoid) chain.add({.name = "sigmoid", .op = VideoOp::kSigmoid, .inputs = {}});
  return chain.take();
}

/// Builds ET-Net (Weng et al., ICCV 2021): the U-Net of E2VID with transformers at the coarsest resolution instead of
/// the residual blocks. The output of each encoder passes through transformers of its own. The network ends in a
/// sigmoid and has 22,175,361 parameters.
inline model::Network event_transformer(const EventTransformerOptions& options = {}) {
  Chain chain(options.bins);
  std::vector<std::string> skips = encode(chain, options.channels, options.encoders);
  Transformers(chain, options).add(skips);
  decode(chain, options.channels << options.encoders, std::move(skips));
  chain.add({.name = "sigmoid", .op = VideoOp::kSigmoid, .inputs = {}});
  return chain.take();
}

}  // namespace e2lf::video
