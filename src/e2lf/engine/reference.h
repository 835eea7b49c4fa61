// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/model/model.h"

namespace e2lf::engine {

/// The network on a whole image by plain loops, sums in double precision: what every kernel is compared with. Input
/// float32 [input_channels, height, width], result [output channels, height, width] at the output's resolution. Sizes
/// that do not fit, of the image (model::size_multiple()) or of weights, break the contract. Fails as
/// model::infer_shapes does, and with kNotFound when a weight is missing.
[[nodiscard]] Result<std::vector<float>> run_reference(const model::Network& network, const model::Weights& weights,
                                                       std::span<const float> input, size_t height, size_t width);

}  // namespace e2lf::engine
