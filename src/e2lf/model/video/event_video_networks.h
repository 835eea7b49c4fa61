// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

#include "e2lf/model/network.h"

namespace e2lf::model {

/// FireNet (Scheerlinck et al., WACV 2020), which is FireNet+ too: a 3x3 convolution, twice a GRU and a residual block,
/// and a 1x1 convolution to one channel, all at full resolution. 37,777 parameters.
[[nodiscard]] Network firenet(size_t bins = 5, size_t channels = 16);

/// Sizes of the recurrent U-Net of E2VID.
struct EventUnetOptions {
  size_t bins = 5;
  size_t channels = 32;  ///< of the head; each encoder doubles them
  size_t encoders = 3, blocks = 2;
  bool ends_in_sigmoid = false;
};

/// The recurrent U-Net of E2VID (Rebecq et al., TPAMI 2021), E2VID+ and SSL-E2VID, batch normalisation folded: a 5x5
/// convolution, encoders of a strided 5x5 convolution and an LSTM each, residual blocks, decoders of bilinear
/// upsampling and a 5x5 convolution each, what the encoders gave added before each; a 1x1 convolution to one channel.
[[nodiscard]] Network event_unet(const EventUnetOptions& options = {});

/// Sizes of ET-Net.
struct EventTransformerOptions {
  size_t bins = 5;
  size_t channels = 32;  ///< of the head; each encoder doubles them
  size_t encoders = 3;
  size_t self_layers = 3, cross_layers = 2, heads = 8;  ///< of each encoder's transformers
  size_t wide = 1024;                                   ///< channels between a transformer layer's last two
};

/// ET-Net (Weng et al., ICCV 2021): E2VID's U-Net, with transformers at the coarsest resolution in place of the
/// residual blocks; what each encoder gave goes through those of its own. Ends in a sigmoid. 22,175,361 parameters.
[[nodiscard]] Network event_transformer(const EventTransformerOptions& options = {});

}  // namespace e2lf::model
