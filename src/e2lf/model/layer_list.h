// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "e2lf/model/network.h"

/// What networks are built of; internal to this module and to training.
namespace e2lf::model {

/// Appends layers to a network. Each function returns the name of the last one, so that they can be chained.
struct LayerList {
  Network& network;

  std::string add(Layer layer);
  std::string conv(const std::string& name, const std::string& input, size_t channels, size_t kernel = 3,
                   size_t stride = 1);

  /// Doubles the resolution by a transposed convolution.
  std::string doubling(const std::string& name, const std::string& input, size_t channels);

  /// Adds residual blocks of two 3x3 convolutions, with ReLU between them.
  std::string blocks(const std::string& name, std::string input, size_t channels, size_t count = 1);

  /// Adds the levels of a U-Net from the resolution of `input` on: strided 2x2 convolutions down, transposed ones up,
  /// additive skip connections, and `blocks` residual blocks on each side of each level (empty = one). `after_half`
  /// adds what follows the first reduction of the resolution; null = nothing. The result has the resolution of `input`.
  std::string levels(const std::string& input, const std::vector<size_t>& widths,
                     const std::vector<size_t>& blocks_of = {},
                     const std::function<std::string(const std::string& half)>& after_half = nullptr);
};

}  // namespace e2lf::model
