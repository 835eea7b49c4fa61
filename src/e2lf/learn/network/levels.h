// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "e2lf/model/network.h"

namespace e2lf::learn {

/// Appends layers to a network, each named and returned by its name.
struct LayerList {
  model::Network& network;

  std::string add(model::Layer layer);
  std::string conv(const std::string& name, const std::string& input, size_t channels, size_t kernel,
                   size_t stride = 1);

  /// Adds a residual block of two 3x3 convolutions.
  std::string block(const std::string& name, const std::string& input, size_t channels);
};

/// Adds the levels of a U-Net, of one block each, with these widths from the resolution of `input` on. `after_half`
/// adds what follows the first reduction of the resolution; null = nothing. Returns the last layer, of the resolution
/// of `input`.
std::string add_levels(LayerList& layers, const std::string& input, const std::vector<size_t>& widths,
                       const std::function<std::string(const std::string& half)>& after_half = nullptr);

}  // namespace e2lf::learn
