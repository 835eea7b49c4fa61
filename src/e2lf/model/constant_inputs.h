// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "e2lf/model/model.h"

namespace e2lf::model {

/// A network and its weights.
struct WeightedNetwork {
  Network network;
  Weights weights;
};

/// Builds input channels [first, first + values.size()), of which each has one value for all pixels, into the weights:
/// in their place, the result has one channel, which must be 1 for all pixels. It is as it was but for rounding, also
/// at the borders, where the padding of that channel is 0. Nothing if layers other than convolutions and pixel
/// unshuffles read the input.
[[nodiscard]] std::optional<WeightedNetwork> with_constant_inputs(const Network& network, const Weights& weights,
                                                                  size_t first, std::span<const float> values);

}  // namespace e2lf::model
