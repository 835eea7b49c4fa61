// SPDX-License-Identifier: MIT
#include "e2lf/engine/unread_layers.h"

#include <set>
#include <string>

namespace e2lf::engine {

// Rows of a tensor without readers would never be released, nor would those from which they are computed.
model::Network without_unread_layers(const model::Network& network) {
  std::set<std::string> read = {network.layers.back().name};
  model::Network result{network.input_channels, {}};
  for (size_t i = network.layers.size(); i-- > 0;) {
    const model::Layer& layer = network.layers[i];
    if (read.count(layer.name) == 0) continue;
    read.insert(layer.inputs.begin(), layer.inputs.end());
    read.insert(layer.residual);
    result.layers.insert(result.layers.begin(), layer);
  }
  return result;
}

}  // namespace e2lf::engine
