// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "e2lf/engine/conv.h"

namespace e2lf::engine {

/// Composes a chain of stride-1 convolutions without anything between them into the single convolution that equals it
/// away from the border: kernel = 1 + sum(kernel_i - 1), with taps and bias computed in double precision. ReLU,
/// residual and types are those of the last convolution.
[[nodiscard]] ConvSpec compose(const std::vector<ConvSpec>& chain);

/// Returns the distance from the image border within which compose() differs from the chain, whose intermediate results
/// are zero outside of the image: the sum of the radii of all but the first convolution, e.g. 4 for three 5x5 kernels.
[[nodiscard]] size_t frame_width(const std::vector<ConvSpec>& chain);

/// Returns true if computing compose(chain) costs less than the chain itself.
[[nodiscard]] bool worth_composing(const std::vector<ConvSpec>& chain);

/// Makes a kernel that computes a chain by its composition and, within the frame at the border, layer by layer. Only
/// the last convolution may have a ReLU, and none may have a residual.
[[nodiscard]] std::unique_ptr<Kernel> make_chain(const std::vector<ConvSpec>& chain);

}  // namespace e2lf::engine
