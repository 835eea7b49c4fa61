// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/model/model.h"

namespace e2lf::engine {

/// Runs the network on a whole image by plain loops with sums in double precision, as the reference for every kernel.
/// The input is float32 [input_channels, height, width], and the result is [output channels, height, width] at the
/// resolution of the output. Sizes of the image (model::size_multiple()) or of weights that do not fit break the
/// contract. Fails as model::infer_shapes does, and with kNotFound if a weight is missing.
[[nodiscard]] Result<std::vector<float>> run_reference(const model::Network& network, const model::Weights& weights,
                                                       std::span<const float> input, size_t height, size_t width);

/// The memory of recurrent layers: h' by the name of the layer, c' of kConvLstm by "<name>.memory", and the last output
/// by the name of kPrevious; [channel, y, x] each. If it is empty, the network is at rest.
using ReferenceState = std::map<std::string, std::vector<float>>;

/// Runs one frame in the same way, with a state that is carried from frame to frame.
[[nodiscard]] Result<std::vector<float>> run_reference(const model::Network& network, const model::Weights& weights,
                                                       std::span<const float> input, size_t height, size_t width,
                                                       ReferenceState& state);

}  // namespace e2lf::engine
