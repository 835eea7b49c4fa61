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

}  // namespace e2lf::model
