// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "e2lf/engine/kernel.h"
#include "e2lf/engine/plan.h"
#include "e2lf/model/network.h"

namespace e2lf::engine {

/// Returns true if a layer only moves or adds elements.
[[nodiscard]] bool is_reshape(const model::Layer& layer);

/// Makes the kernel of such a layer. `in_channels` has one entry per input. Inputs and output have the same element
/// type. If `phases_first` is set, the channels of the input of a pixel shuffle are ordered [phase, channel] instead of
/// [channel, phase], so that whole pixels are copied.
[[nodiscard]] std::unique_ptr<Kernel> make_reshape(const model::Layer& layer, const std::vector<size_t>& in_channels,
                                                   const TensorSpec& output, bool phases_first = false);

/// Makes the kernel of model::Op::kSigmoid, whose input and output have the same type.
[[nodiscard]] std::unique_ptr<Kernel> make_sigmoid(size_t channels, ElementType type);

}  // namespace e2lf::engine
