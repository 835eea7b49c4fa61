// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "e2lf/engine/conv.h"

namespace e2lf::engine {

/// The one convolution that equals a chain of stride-1 convolutions with nothing between them, away from the border:
/// kernel = 1 + sum(kernel_i - 1), taps and bias composed in double precision. ReLU, residual and the types are the
/// last one's.
[[nodiscard]] ConvSpec compose(const std::vector<ConvSpec>& chain);

/// How far from the image's border compose() differs from the chain, whose inner results are zero outside the image:
/// the sum of the radii of all but the first. 4 for three 5x5 kernels.
[[nodiscard]] size_t frame_width(const std::vector<ConvSpec>& chain);

/// Whether computing compose(chain) costs less than the chain itself.
[[nodiscard]] bool worth_composing(const std::vector<ConvSpec>& chain);

/// A kernel that computes a chain by its composition and, within the frame at the border, layer by layer as it stands.
/// Only the last convolution may have a ReLU; none has a residual.
[[nodiscard]] std::unique_ptr<Kernel> make_chain(const std::vector<ConvSpec>& chain);

}  // namespace e2lf::engine
