// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/files/safetensors.h"
#include "testing/test_networks.h"

/// Checkpoints of event-to-video networks with random weights, under the names and in the shapes of the published ones.
namespace e2lf::model {

class CheckpointMaker {
 public:
  Safetensors tensors;

  void add(const std::string& name, const std::vector<size_t>& shape, float scale) {
    size_t size = 1;
    for (const size_t extent : shape) size *= extent;
    tensors.tensors[name] = make_tensor(shape, engine::random_values(size, ++seed_, scale));
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
    tensors.tensors[key + ".running_var"] = make_tensor({channels}, variance);
    const std::vector<uint8_t> batches(8);
    tensors.tensors[key + ".num_batches_tracked"] = {"I64", {}, batches};
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
  bool is_dynamic = false;  ///< the first decoder is HyperE2VID's
};

/// 6 filters of 5x5 as weighted sums of 12 bases.
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

}  // namespace e2lf::model
