// SPDX-License-Identifier: MIT
#include "e2lf/engine/video/reference_operations.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/contract.h"
#include "e2lf/base/threads.h"

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

/// Computes one head of one pixel. `first` is the first channel of the head.
void attend(const ReferencePlanes& queries, const ReferencePlanes& keys, const ReferencePlanes& values, size_t first,
            size_t size, size_t pixel, ReferencePlanes& output) {
  const size_t pixels = keys.height * keys.width;
  std::vector<double> shares(pixels, 0.0);
  for (size_t c = first; c < first + size; ++c) {
    const double query = queries.values[c * pixels + pixel];
    for (size_t i = 0; i < pixels; ++i) shares[i] += query * keys.values[c * pixels + i];
  }
  const double top = *std::max_element(shares.begin(), shares.end());
  double total = 0.0;
  for (double& share : shares) {
    share = std::exp((share - top) / std::sqrt(static_cast<double>(size)));
    total += share;
  }
  for (size_t c = first; c < first + size; ++c) {
    double sum = 0.0;
    for (size_t i = 0; i < pixels; ++i) sum += shares[i] * values.values[c * pixels + i];
    output.values[c * pixels + pixel] = static_cast<float>(sum / total);
  }
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

ReferencePlanes reference_attention(const ReferencePlanes& queries, const ReferencePlanes& keys,
                                    const ReferencePlanes& values, size_t heads) {
  ReferencePlanes output(queries.channels, queries.height, queries.width);
  const size_t pixels = queries.height * queries.width, size = queries.channels / heads;
  parallel_for(heads * pixels, 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      attend(queries, keys, values, i / pixels * size, size, i % pixels, output);
    }
  });
  return output;
}

ReferencePlanes reference_layer_norm(const ReferencePlanes& input, const ReferenceKernel& weights) {
  constexpr double kEps = 1e-5;
  ReferencePlanes output(input.channels, input.height, input.width);
  const size_t pixels = input.height * input.width;
  const auto channels = static_cast<double>(input.channels);
  for (size_t i = 0; i < pixels; ++i) {
    double mean = 0.0, variance = 0.0;
    for (size_t c = 0; c < input.channels; ++c) mean += input.values[c * pixels + i] / channels;
    for (size_t c = 0; c < input.channels; ++c) {
      variance += std::pow(input.values[c * pixels + i] - mean, 2) / channels;
    }
    for (size_t c = 0; c < input.channels; ++c) {
      const double value = (input.values[c * pixels + i] - mean) / std::sqrt(variance + kEps);
      output.values[c * pixels + i] = static_cast<float>(value * weights.weight[c] + weights.bias[c]);
    }
  }
  return output;
}

float reference_position_code(const ReferencePlanes& input, size_t c, size_t y, size_t x) {
  const double exponent = static_cast<double>(c / 2 * 2) / static_cast<double>(input.channels);
  const double angle = static_cast<double>(y * input.width + x) / std::pow(10000.0, exponent);
  return static_cast<float>(c % 2 == 0 ? std::sin(angle) : std::cos(angle));
}

}  // namespace e2lf::engine
