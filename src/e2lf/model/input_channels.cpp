// SPDX-License-Identifier: MIT
// Changes the input channels of networks; declared in network.h.
#include <algorithm>
#include <map>
#include <utility>

#include "e2lf/base/result.h"
#include "e2lf/model/network.h"

namespace e2lf::model {
namespace {

/// The weights [out, in, taps] of a convolution whose input channel c consists of channels [c * phases, (c + 1) *
/// phases).
std::vector<float> combine(const std::vector<float>& weight, size_t in, size_t taps, size_t phases, size_t first,
                           std::span<const float> values) {
  const size_t length = in * taps, channel = phases * taps;
  std::vector<float> result;
  for (size_t out = 0; out < weight.size() / length; ++out) {
    const auto from = weight.begin() + static_cast<ptrdiff_t>(out * length);
    const auto constant = from + static_cast<ptrdiff_t>(first * channel);
    result.insert(result.end(), from, constant);
    for (size_t i = 0; i < channel; ++i) {
      double sum = 0;
      for (size_t c = 0; c < values.size(); ++c) {
        sum += double{values[c]} * constant[static_cast<ptrdiff_t>(c * channel + i)];
      }
      result.push_back(static_cast<float>(sum));
    }
    result.insert(result.end(), constant + static_cast<ptrdiff_t>(values.size() * channel),
                  from + static_cast<ptrdiff_t>(length));
  }
  return result;
}

/// Calls `change(weight, taps, phases)` with the weights of each convolution that reads the input, whose channels each
/// became `phases`. Returns false if other layers than convolutions and pixel unshuffles read it.
template <typename Change>
bool change_input_weights(const Network& network, Weights& weights, const Change& change) {
  std::map<std::string, size_t> phases = {{"input", 1}};  // of the input and of what is unshuffled from it
  for (const Layer& layer : network.layers) {
    const auto is_input = [&](const std::string& name) { return phases.contains(name); };
    if (is_input(layer.residual)) return false;
    if (std::none_of(layer.inputs.begin(), layer.inputs.end(), is_input)) continue;
    const size_t read = phases[layer.inputs.front()];
    if (layer.op == Op::kPixelUnshuffle && !layer.relu) {
      phases[layer.name] = read * layer.stride * layer.stride;
    } else if (layer.op == Op::kConv) {
      change(weights.at(layer.name + ".weight"), layer.kernel * layer.kernel, read);
    } else {
      return false;
    }
  }
  return true;
}

}  // namespace

std::optional<WeightedNetwork> with_constant_inputs(const Network& network, const Weights& weights, size_t first,
                                                    std::span<const float> values) {
  E2LF_REQUIRE(!values.empty() && first + values.size() <= network.input_channels, "the network has no such inputs");
  WeightedNetwork result{network, weights};
  result.network.input_channels -= values.size() - 1;
  const auto change = [&](std::vector<float>& weight, size_t taps, size_t phases) {
    weight = combine(weight, network.input_channels * phases, taps, phases, first, values);
  };
  if (!change_input_weights(network, result.weights, change)) return std::nullopt;
  return result;
}

std::optional<WeightedNetwork> with_unused_inputs(const Network& network, const Weights& weights, size_t first,
                                                  size_t count) {
  E2LF_REQUIRE(first <= network.input_channels, "the network has no such input");
  WeightedNetwork result{network, weights};
  result.network.input_channels += count;
  const auto change = [&](std::vector<float>& weight, size_t taps, size_t phases) {
    const size_t length = network.input_channels * phases * taps, inserted = count * phases * taps;
    std::vector<float> longer;
    longer.reserve(weight.size() / length * (length + inserted));
    for (auto from = weight.begin(); from != weight.end(); from += static_cast<ptrdiff_t>(length)) {
      const auto place = from + static_cast<ptrdiff_t>(first * phases * taps);
      longer.insert(longer.end(), from, place);
      longer.resize(longer.size() + inserted);
      longer.insert(longer.end(), place, from + static_cast<ptrdiff_t>(length));
    }
    weight = std::move(longer);
  };
  if (!change_input_weights(network, result.weights, change)) return std::nullopt;
  return result;
}

}  // namespace e2lf::model
