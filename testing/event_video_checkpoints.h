// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/files/safetensors.h"
#include "testing/test_networks.h"

/// Makes checkpoints of event-to-video networks with random weights, with the names and shapes of the published ones.
namespace e2lf::video {

class CheckpointMaker {
 public:
  Safetensors tensors;

  void add(const std::string& name, const std::vector<size_t>& shape, float scale) {
    size_t size = 1;
    for (const size_t extent : shape) size *= extent;
    tensors.tensors[name] = make_npy<float>(shape, engine::random_values(size, ++seed_, scale));
  }

  void conv(const std::string& key, size_t in, size_t out, size_t kernel, bool has_bias = true) {
    add(key + ".weight", {out, in, kernel, kernel}, std::sqrt(3.0F / static_cast<float>(in * kernel * kernel)));
    if (has_bias) add(key + ".bias", {out}, 0.2F);
  }

  void norm(const std::string& key, size_t channels) {
    add(key + ".running_mean", {channels}, 0.3F);
    add(key + ".weight", {channels}, 0.5F);
    add(key + ".bias", {channels}, 0.5F);
    std::vector<float> variance = engine::random_values(channels, ++seed_, 0.4F);
    for (float& value : variance) value += 0.8F;
    tensors.tensors[key + ".running_var"] = make_npy<float>({channels}, variance);
    const std::vector<uint8_t> batches(8);
    tensors.tensors[key + ".num_batches_tracked"] = {"i8", {}, 8, {}, batches};
  }

  void gru(const std::string& key, size_t in, size_t channels) {
    for (const char* gate : {".reset_gate", ".update_gate", ".out_gate"}) conv(key + gate, in + channels, channels, 3);
  }

  void block(const std::string& key, size_t channels, bool is_normalised = false) {
    for (const char* part : {"1", "2"}) {
      conv(cat(key, ".conv", part), channels, channels, 3, !is_normalised);
      if (is_normalised) norm(cat(key, ".bn", part), channels);
    }
  }

 private:
  uint64_t seed_ = 0;
};

inline Safetensors firenet_checkpoint(bool is_legacy) {
  CheckpointMaker make;
  const std::string net = is_legacy ? "net." : "";
  make.conv(net + (is_legacy ? "head.conv.conv2d" : "head.conv2d"), 5, 16, 3);
  make.gru(net + (is_legacy ? "head.recurrent_block" : "G1"), 16, 16);
  make.block(net + (is_legacy ? "resblocks.0.conv" : "R1"), 16);
  make.gru(net + (is_legacy ? "resblocks.0.recurrent_block" : "G2"), 16, 16);
  make.block(net + (is_legacy ? "resblocks.1" : "R2"), 16);
  make.conv(net + "pred.conv2d", 16, 1, 1);
  return make.tensors;
}

struct UnetCheckpoint {
  bool is_normalised = false;
  size_t channels = 32;  ///< of the head
  size_t encoders = 3, blocks = 2;
  bool is_dynamic = false;  ///< the first decoder is that of HyperE2VID
};

/// Adds 6 filters of 5x5 as weighted sums of 12 bases.
inline void add_dynamic_decoder(CheckpointMaker& make, const std::string& key, size_t in, size_t out) {
  make.conv(key + ".context_fusion.conv", 6, 32, 3);
  const std::string atoms = key + ".dynamic_atom_generation";
  make.add(atoms + ".bases", {12, 25}, 0.4F);
  make.conv(atoms + ".bases_net.0", 32, 64, 3);
  make.norm(atoms + ".bases_net.1", 64);
  make.conv(atoms + ".bases_net.3", 64, 72, 3);
  make.norm(atoms + ".bases_net.4", 72);
  make.add(key + ".dynamic_conv.compositional_coefficients", {out, in * 6, 1, 1},
           std::sqrt(0.5F / static_cast<float>(in)));
  make.add(key + ".dynamic_conv.bias", {out}, 0.2F);
}

inline Safetensors unet_checkpoint(const UnetCheckpoint& sizes) {
  CheckpointMaker make;
  const std::string net = "unetrecurrent.";
  const bool has_bias = !sizes.is_normalised;
  const auto conv_layer = [&](const std::string& key, size_t in, size_t out, size_t kernel) {
    make.conv(key + ".conv2d", in, out, kernel, has_bias);
    if (sizes.is_normalised) make.norm(key + ".norm_layer", out);
  };
  make.conv(net + "head.conv2d", 5, sizes.channels, 5);
  size_t channels = sizes.channels;
  for (size_t i = 0; i < sizes.encoders; ++i, channels *= 2) {
    const std::string key = cat(net, "encoders.", i);
    conv_layer(key + ".conv", channels, 2 * channels, 5);
    make.conv(key + ".recurrent_block.Gates", 4 * channels, 8 * channels, 3);
  }
  for (size_t i = 0; i < sizes.blocks; ++i) make.block(cat(net, "resblocks.", i), channels, sizes.is_normalised);
  for (size_t i = 0; i < sizes.encoders; ++i, channels /= 2) {
    const std::string key = cat(net, "decoders.", i);
    if (sizes.is_dynamic && i == 0) {
      add_dynamic_decoder(make, key, channels, channels / 2);
    } else {
      conv_layer(key, channels, channels / 2, 5);
    }
  }
  conv_layer(net + "pred", channels, 1, 1);
  return make.tensors;
}

struct TransformerCheckpoint {
  size_t channels = 32;  ///< of the head
  size_t self_layers = 3, cross_layers = 2, wide = 1024;
};

/// Makes a checkpoint of ET-Net.
class TransformerMaker {
 public:
  explicit TransformerMaker(const TransformerCheckpoint& sizes) : sizes_(sizes), size_(8 * sizes.channels) {}

  Safetensors make() {
    const size_t channels = sizes_.channels;
    make_.conv("head.conv2d", 5, channels, 5);
    for (size_t i = 0; i < 3; ++i) {
      const std::string key = cat("DownsampleConv.", i);
      make_.conv(key + ".conv.conv2d", channels << i, channels << (i + 1), 5);
      make_.conv(key + ".recurrent_block.Gates", channels << (i + 2), channels << (i + 3), 3);
      make_.conv(cat("UpsampleConv.", i, ".conv2d"), size_ >> i, size_ >> (i + 1), 5);
    }
    make_.conv("split1", 4 * channels, size_, 2);
    make_.conv("split2", 2 * channels, size_, 4);
    for (size_t scale = 0; scale < 3; ++scale) {
      for (size_t i = 0; i < sizes_.self_layers; ++i) {
        layer(cat("trans_encoder", scale, ".encoder.layers.", i), {"self_attn"}, {"norm1", "norm2"});
      }
      for (size_t i = 0; i < sizes_.cross_layers; ++i) {
        layer(cat("trans_decoder", scale, ".decoder.layers.", i), {"self_attn", "cross_attn"},
              {"norm1", "norm21", "norm22", "norm3"});
      }
    }
    make_.conv("pred.conv2d", channels, 1, 1);
    return make_.tensors;
  }

 private:
  void layer(const std::string& key, const std::vector<std::string>& attentions,
             const std::vector<std::string>& norms) {
    for (const std::string& name : attentions) {
      linear(key + "." + name + ".in_proj_", size_, 3 * size_);
      linear(key + "." + name + ".out_proj.", size_, size_);
    }
    linear(key + ".linear1.", size_, sizes_.wide);
    linear(key + ".linear2.", sizes_.wide, size_);
    for (const std::string& name : norms) {
      std::vector<float> weight = engine::random_values(size_, ++seed_, 0.3F);
      for (float& value : weight) value += 1.0F;
      make_.tensors.tensors[key + "." + name + ".weight"] = make_npy<float>({size_}, weight);
      make_.add(key + "." + name + ".bias", {size_}, 0.2F);
    }
  }

  void linear(const std::string& key, size_t in, size_t out) {
    make_.add(key + "weight", {out, in}, std::sqrt(3.0F / static_cast<float>(in)));
    make_.add(key + "bias", {out}, 0.2F);
  }

  TransformerCheckpoint sizes_;
  size_t size_;  ///< channels of the transformers
  CheckpointMaker make_;
  uint64_t seed_ = 1000;
};

inline Safetensors transformer_checkpoint(const TransformerCheckpoint& sizes) {
  return TransformerMaker(sizes).make();
}

}  // namespace e2lf::video
