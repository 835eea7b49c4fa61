// SPDX-License-Identifier: MIT
#include "e2lf/engine/video/reference_cells.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/contract.h"

namespace e2lf::engine {
namespace {

double sigmoid(double x) {
  return 1.0 / (1.0 + std::exp(-x));
}

/// Concatenates x and h along the channels.
ReferencePlanes joined(const ReferencePlanes& input, const std::vector<float>& hidden) {
  ReferencePlanes both(input.channels + hidden.size() / (input.height * input.width), input.height, input.width);
  std::copy(hidden.begin(), hidden.end(), std::copy(input.values.begin(), input.values.end(), both.values.begin()));
  return both;
}

}  // namespace

std::vector<float>& remembered(ReferenceState& state, const std::string& name, size_t size) {
  std::vector<float>& values = state[name];
  if (values.empty()) values.assign(size, 0.0F);
  E2LF_REQUIRE(values.size() == size, "the state is of another network or size of image");
  return values;
}

ReferencePlanes reference_gru(const model::Layer& layer, const ReferencePlanes& input, const ReferenceKernel& gates,
                              const ReferenceKernel& candidate, ReferenceState& state) {
  const size_t out = layer.out_channels, size = out * input.height * input.width;
  std::vector<float>& hidden = remembered(state, layer.name, size);
  const ReferencePlanes sums = reference_conv(joined(input, hidden), 2 * out, layer.kernel, gates);
  std::vector<float> reset = hidden;
  for (size_t i = 0; i < size; ++i) reset[i] = static_cast<float>(sigmoid(sums.values[size + i]) * hidden[i]);
  const ReferencePlanes wanted = reference_conv(joined(input, reset), out, layer.kernel, candidate);
  for (size_t i = 0; i < size; ++i) {
    const double update = sigmoid(sums.values[i]);
    hidden[i] = static_cast<float>((1.0 - update) * hidden[i] + update * std::tanh(wanted.values[i]));
  }
  ReferencePlanes output(out, input.height, input.width);
  output.values = hidden;
  return output;
}

ReferencePlanes reference_lstm(const model::Layer& layer, const ReferencePlanes& input, const ReferenceKernel& gates,
                               ReferenceState& state) {
  const size_t out = layer.out_channels, size = out * input.height * input.width;
  std::vector<float>& hidden = remembered(state, layer.name, size);
  std::vector<float>& memory = remembered(state, layer.name + ".memory", size);
  const ReferencePlanes sums = reference_conv(joined(input, hidden), 4 * out, layer.kernel, gates);
  const auto part = [&](size_t gate, size_t i) { return static_cast<double>(sums.values[gate * size + i]); };
  for (size_t i = 0; i < size; ++i) {
    const double kept = sigmoid(part(1, i)) * memory[i], added = sigmoid(part(0, i)) * std::tanh(part(3, i));
    memory[i] = static_cast<float>(kept + added);
    hidden[i] = static_cast<float>(sigmoid(part(2, i)) * std::tanh(kept + added));
  }
  ReferencePlanes output(out, input.height, input.width);
  output.values = hidden;
  return output;
}

}  // namespace e2lf::engine
