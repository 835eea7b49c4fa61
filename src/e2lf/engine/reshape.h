// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "e2lf/engine/kernel.h"
#include "e2lf/model/network.h"

namespace e2lf::engine {

/// The kernel of a layer that moves or adds elements: every op but the convolutions. `in_channels` has one entry per
/// input; inputs and output hold elements of the same type. `phases_first`: the input of a pixel shuffle has its
/// channels in the order [phase, channel] instead of [channel, phase], so that whole pixels are copied.
[[nodiscard]] std::unique_ptr<Kernel> make_reshape(const model::Layer& layer, const std::vector<size_t>& in_channels,
                                                   ElementType type, bool phases_first = false);

}  // namespace e2lf::engine
