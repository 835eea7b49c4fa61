// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <span>
#include <string>
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

/// What recurrent layers remember: h' by the layer's name, c' of kConvLstm by "<name>.memory", the last output by that
/// of kPrevious; [channel, y, x] each. Empty: at rest.
using ReferenceState = std::map<std::string, std::vector<float>>;

/// The same with a state that goes from frame to frame.
[[nodiscard]] Result<std::vector<float>> run_reference(const model::Network& network, const model::Weights& weights,
                                                       std::span<const float> input, size_t height, size_t width,
                                                       ReferenceState& state);

}  // namespace e2lf::engine
