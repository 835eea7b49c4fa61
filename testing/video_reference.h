// SPDX-License-Identifier: MIT
// The operations of networks for frames by plain loops, as the reference for their kernels.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "e2lf/base/threads.h"
#include "e2lf/video/operations.h"
#include "testing/engine_reference.h"

namespace e2lf::video::reference {

using engine::ReferenceCall, engine::ReferenceKernel, engine::ReferencePlanes;

inline double sigmoid(double x) {
  return 1.0 / (1.0 + std::exp(-x));
}

/// Concatenates x and h along the channels.
inline ReferencePlanes joined(const ReferencePlanes& input, const std::vector<float>& hidden) {
  ReferencePlanes both(input.channels + hidden.size() / (input.height * input.width), input.height, input.width);
  std::copy(hidden.begin(), hidden.end(), std::copy(input.values.begin(), input.values.end(), both.values.begin()));
  return both;
}

/// Returns a convolution of a cell of x and h.
inline Result<ReferencePlanes> cell_conv(const ReferenceCall& call, const std::string& part, size_t out_channels,
                                         const std::vector<float>& hidden) {
  const ReferencePlanes both = joined(*call.inputs[0], hidden);
  const size_t kernel = call.layer.kernel;
  E2LF_ASSIGN_OR_RETURN(
      const ReferenceKernel weights,
      call.kernel(cat(call.layer.name, ".", part), both.channels * kernel * kernel * out_channels, out_channels));
  return engine::reference::same_conv(both, out_channels, kernel, weights);
}

inline Result<ReferencePlanes> gru_reference(ReferenceCall& call) {
  const size_t out = call.layer.out_channels, size = call.output.values.size();
  std::vector<float>& hidden = call.remembered(call.layer.name, size);
  E2LF_ASSIGN_OR_RETURN(const ReferencePlanes sums, cell_conv(call, "gates", 2 * out, hidden));
  std::vector<float> reset = hidden;
  for (size_t i = 0; i < size; ++i) reset[i] = static_cast<float>(sigmoid(sums.values[size + i]) * hidden[i]);
  E2LF_ASSIGN_OR_RETURN(const ReferencePlanes wanted, cell_conv(call, "candidate", out, reset));
  for (size_t i = 0; i < size; ++i) {
    const double update = sigmoid(sums.values[i]);
    hidden[i] = static_cast<float>((1.0 - update) * hidden[i] + update * std::tanh(wanted.values[i]));
  }
  call.output.values = hidden;
  return std::move(call.output);
}

inline Result<ReferencePlanes> lstm_reference(ReferenceCall& call) {
  const size_t out = call.layer.out_channels, size = call.output.values.size();
  std::vector<float>& hidden = call.remembered(call.layer.name, size);
  std::vector<float>& memory = call.remembered(call.layer.name + ".memory", size);
  E2LF_ASSIGN_OR_RETURN(const ReferencePlanes sums, cell_conv(call, "gates", 4 * out, hidden));
  const auto part = [&](size_t gate, size_t i) { return static_cast<double>(sums.values[gate * size + i]); };
  for (size_t i = 0; i < size; ++i) {
    const double kept = sigmoid(part(1, i)) * memory[i], added = sigmoid(part(0, i)) * std::tanh(part(3, i));
    memory[i] = static_cast<float>(kept + added);
    hidden[i] = static_cast<float>(sigmoid(part(2, i)) * std::tanh(kept + added));
  }
  call.output.values = hidden;
  return std::move(call.output);
}

inline Result<ReferencePlanes> previous_reference(ReferenceCall& call) {
  call.output.values = call.remembered(call.layer.name, call.output.values.size());
  return std::move(call.output);
}

inline Result<ReferencePlanes> tanh_reference(ReferenceCall& call) {
  const ReferencePlanes& input = *call.inputs[0];
  call.output.fill([&](size_t c, size_t y, size_t x) {
    return static_cast<float>(std::tanh(static_cast<double>(input.at(c, y, x))));
  });
  return std::move(call.output);
}

inline Result<ReferencePlanes> layer_norm_reference(ReferenceCall& call) {
  constexpr double kEps = 1e-5;
  const ReferencePlanes& input = *call.inputs[0];
  E2LF_ASSIGN_OR_RETURN(const ReferenceKernel weights, call.kernel(call.layer.name, input.channels, input.channels));
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
      call.output.values[c * pixels + i] = static_cast<float>(value * weights.weight[c] + weights.bias[c]);
    }
  }
  return std::move(call.output);
}

inline Result<ReferencePlanes> filter_reference(ReferenceCall& call) {
  const ReferencePlanes &input = *call.inputs[0], &filters = *call.inputs[1];
  const size_t kernel = call.layer.kernel;
  const auto radius = static_cast<ptrdiff_t>(kernel / 2);
  call.output.fill([&](size_t c, size_t y, size_t x) {
    const size_t filter = c / input.channels;
    double sum = 0.0;
    for (size_t tap = 0; tap < kernel * kernel; ++tap) {
      const auto from_y = static_cast<ptrdiff_t>(y + tap / kernel) - radius;
      const auto from_x = static_cast<ptrdiff_t>(x + tap % kernel) - radius;
      const double weight = filters.at(filter * kernel * kernel + tap, y, x);
      sum += weight * input.at_or_zero(c % input.channels, from_y, from_x);
    }
    return static_cast<float>(sum);
  });
  return std::move(call.output);
}

/// Samples between pixels. Positions beyond the edge take the value at the edge.
inline float sample(const ReferencePlanes& input, size_t stride, size_t c, size_t y, size_t x) {
  const auto place = [stride](size_t i, size_t size) {
    const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(stride) - 0.5;
    return std::clamp(at, 0.0, static_cast<double>(size - 1));
  };
  const double at_y = place(y, input.height), at_x = place(x, input.width);
  const auto top = static_cast<size_t>(at_y), left = static_cast<size_t>(at_x);
  const size_t bottom = std::min(top + 1, input.height - 1), right = std::min(left + 1, input.width - 1);
  const double share_y = at_y - static_cast<double>(top), share_x = at_x - static_cast<double>(left);
  return static_cast<float>(
      (1 - share_y) * (1 - share_x) * input.at(c, top, left) + (1 - share_y) * share_x * input.at(c, top, right) +
      share_y * (1 - share_x) * input.at(c, bottom, left) + share_y * share_x * input.at(c, bottom, right));
}

inline Result<ReferencePlanes> bilinear_reference(ReferenceCall& call) {
  const ReferencePlanes& input = *call.inputs[0];
  const size_t stride = call.layer.stride;
  call.output.fill([&](size_t c, size_t y, size_t x) { return sample(input, stride, c, y, x); });
  return std::move(call.output);
}

inline Result<ReferencePlanes> position_code_reference(ReferenceCall& call) {
  const ReferencePlanes& input = *call.inputs[0];
  call.output.fill([&](size_t c, size_t y, size_t x) {
    const double exponent = static_cast<double>(c / 2 * 2) / static_cast<double>(input.channels);
    const double angle = static_cast<double>(y * input.width + x) / std::pow(10000.0, exponent);
    return input.at(c, y, x) + static_cast<float>(c % 2 == 0 ? std::sin(angle) : std::cos(angle));
  });
  return std::move(call.output);
}

/// Computes one head of one pixel. `first` is the first channel of the head.
inline void attend(const ReferenceCall& call, size_t first, size_t size, size_t pixel, ReferencePlanes& output) {
  const ReferencePlanes &queries = *call.inputs[0], &keys = *call.inputs[1], &values = *call.inputs[2];
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

inline Result<ReferencePlanes> attention_reference(ReferenceCall& call) {
  ReferencePlanes& output = call.output;
  const size_t heads = call.layer.integer("heads", 1), pixels = output.height * output.width,
               size = output.channels / heads;
  parallel_for(heads * pixels, 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) attend(call, i / pixels * size, size, i % pixels, output);
  });
  return std::move(output);
}

/// Lets run_reference() compute them.
inline const bool g_is_added = [] {
  engine::added_references().insert({{VideoOp::kAttention, attention_reference},
                                     {VideoOp::kConvGru, gru_reference},
                                     {VideoOp::kConvLstm, lstm_reference},
                                     {VideoOp::kDynamicFilter, filter_reference},
                                     {VideoOp::kLayerNorm, layer_norm_reference},
                                     {VideoOp::kPositionCode, position_code_reference},
                                     {VideoOp::kPrevious, previous_reference},
                                     {VideoOp::kTanh, tanh_reference},
                                     {VideoOp::kUpsampleBilinear, bilinear_reference}});
  return true;
}();

}  // namespace e2lf::video::reference
