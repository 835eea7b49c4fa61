// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "e2lf/model/network.h"

namespace e2lf::video {

/// Builds FireNet (Scheerlinck et al., WACV 2020), which is also the architecture of FireNet+: a 3x3 convolution, two
/// pairs of a GRU and a residual block, and a 1x1 convolution to one channel, all at full resolution. It has 37,777
/// parameters.
[[nodiscard]] model::Network firenet(size_t bins = 5, size_t channels = 16);

/// The sizes of the recurrent U-Net of E2VID.
struct EventUnetOptions {
  size_t bins = 5;
  size_t channels = 32;  ///< channels of the head; each encoder doubles them
  size_t encoders = 3, blocks = 2;
  bool ends_in_sigmoid = false;
};

/// Builds the recurrent U-Net of E2VID (Rebecq et al., TPAMI 2021), E2VID+ and SSL-E2VID, with batch normalisation
/// folded in: a 5x5 convolution; encoders, each with a strided 5x5 convolution and an LSTM; residual blocks; decoders,
/// each with bilinear upsampling and a 5x5 convolution, before which the output of the corresponding encoder is added;
/// and a 1x1 convolution to one channel.
[[nodiscard]] model::Network event_unet(const EventUnetOptions& options = {});

/// The sizes of ET-Net.
struct EventTransformerOptions {
  size_t bins = 5;
  size_t channels = 32;  ///< channels of the head; each encoder doubles them
  size_t encoders = 3;
  size_t self_layers = 3, cross_layers = 2, heads = 8;  ///< per scale of the transformers
  size_t wide = 1024;                                   ///< hidden channels of the feed-forward layers
};

/// Builds ET-Net (Weng et al., ICCV 2021): the U-Net of E2VID with transformers at the coarsest resolution instead of
/// the residual blocks. The output of each encoder passes through transformers of its own. The network ends in a
/// sigmoid and has 22,175,361 parameters.
[[nodiscard]] model::Network event_transformer(const EventTransformerOptions& options = {});

}  // namespace e2lf::video
