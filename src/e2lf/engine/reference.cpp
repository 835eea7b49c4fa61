// SPDX-License-Identifier: MIT
#include "e2lf/engine/reference.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "e2lf/base/contract.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/engine/video/reference_operations.h"

namespace e2lf::engine {
namespace {

using model::Layer;
using model::Op;
using Planes = ReferencePlanes;

/// Adds weight * input, shifted by (dy, dx), to one row of sums. Values outside of the image count as zero.
void add_tap(const Planes& input, size_t channel, ptrdiff_t y, ptrdiff_t dx, float weight, std::vector<double>& sums) {
  if (y < 0 || y >= static_cast<ptrdiff_t>(input.height)) return;
  const auto width = static_cast<ptrdiff_t>(input.width);
  const float* row = &input.values[(channel * input.height + static_cast<size_t>(y)) * input.width];
  for (ptrdiff_t x = std::max<ptrdiff_t>(0, -dx); x < std::min(width, width - dx); ++x) {
    sums[static_cast<size_t>(x)] += static_cast<double>(weight) * row[x + dx];
  }
}

float at_or_zero(const Planes& input, size_t channel, ptrdiff_t y, ptrdiff_t x) {
  const auto height = static_cast<ptrdiff_t>(input.height), width = static_cast<ptrdiff_t>(input.width);
  const bool is_inside = y >= 0 && y < height && x >= 0 && x < width;
  return is_inside ? input.at(channel, static_cast<size_t>(y), static_cast<size_t>(x)) : 0.0F;
}

void conv_row(const Planes& input, const Layer& layer, const ReferenceKernel& kernel, size_t out, size_t y,
              Planes& output) {
  const auto radius = static_cast<ptrdiff_t>(layer.kernel / 2);
  const size_t k = layer.kernel;
  std::vector<double> sums(output.width, kernel.bias[out]);
  for (size_t in = 0; in < input.channels; ++in) {
    const float* taps = &kernel.weight[(out * input.channels + in) * k * k];
    for (size_t tap = 0; tap < k * k; ++tap) {
      const auto dy = static_cast<ptrdiff_t>(tap / k);
      const auto dx = static_cast<ptrdiff_t>(tap % k);
      if (layer.stride == 1) {
        add_tap(input, in, static_cast<ptrdiff_t>(y) + dy - radius, dx - radius, taps[tap], sums);
      } else {
        const ptrdiff_t before = layer.stride == k ? 0 : radius;
        const auto in_y = static_cast<ptrdiff_t>(y * layer.stride) + dy - before;
        for (size_t x = 0; x < output.width; ++x) {
          const auto in_x = static_cast<ptrdiff_t>(x * layer.stride) + dx - before;
          sums[x] += static_cast<double>(taps[tap]) * at_or_zero(input, in, in_y, in_x);
        }
      }
    }
  }
  for (size_t x = 0; x < output.width; ++x) output.at(out, y, x) = static_cast<float>(sums[x]);
}

void transposed_row(const Planes& input, const Layer& layer, const ReferenceKernel& kernel, size_t out, size_t y,
                    Planes& output) {
  const size_t s = layer.stride;
  for (size_t x = 0; x < output.width; ++x) {
    double sum = kernel.bias[out];
    for (size_t in = 0; in < input.channels; ++in) {
      const float tap = kernel.weight[((in * output.channels + out) * s + y % s) * s + x % s];
      sum += static_cast<double>(tap) * input.at(in, y / s, x / s);
    }
    output.at(out, y, x) = static_cast<float>(sum);
  }
}

/// Samples between pixels. Positions beyond the edge take the value at the edge.
float bilinear(const Planes& input, size_t stride, size_t c, size_t y, size_t x) {
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

/// Applies the filter of a pixel to its neighbourhood.
float filtered(const Planes& input, const Planes& filters, size_t kernel, size_t c, size_t y, size_t x) {
  const size_t filter = c / input.channels;
  const auto radius = static_cast<ptrdiff_t>(kernel / 2);
  double sum = 0.0;
  for (size_t tap = 0; tap < kernel * kernel; ++tap) {
    const auto from_y = static_cast<ptrdiff_t>(y + tap / kernel) - radius;
    const auto from_x = static_cast<ptrdiff_t>(x + tap % kernel) - radius;
    const double weight = filters.at(filter * kernel * kernel + tap, y, x);
    sum += weight * at_or_zero(input, c % input.channels, from_y, from_x);
  }
  return static_cast<float>(sum);
}

/// Computes one element of any operation without weights.
float element(const std::vector<const Planes*>& inputs, const Layer& layer, size_t c, size_t y, size_t x) {
  const size_t s = layer.stride;
  const Planes& input = *inputs[0];
  switch (layer.op) {
    case Op::kPixelUnshuffle:
      return input.at(c / (s * s), y * s + c % (s * s) / s, x * s + c % s);
    case Op::kPixelShuffle:
      return input.at(c * s * s + y % s * s + x % s, y / s, x / s);
    case Op::kUpsample:
      return input.at(c, y / s, x / s);
    case Op::kUpsampleBilinear:
      return bilinear(input, s, c, y, x);
    case Op::kSigmoid:
      return static_cast<float>(1.0 / (1.0 + std::exp(-static_cast<double>(input.at(c, y, x)))));
    case Op::kTanh:
      return static_cast<float>(std::tanh(static_cast<double>(input.at(c, y, x))));
    case Op::kDynamicFilter:
      return filtered(input, *inputs[1], layer.kernel, c, y, x);
    case Op::kAdd:
    case Op::kMean: {
      float sum = 0.0F;
      for (const Planes* each : inputs) sum += each->at(c, y, x);
      return layer.op == Op::kAdd ? sum : sum / static_cast<float>(inputs.size());
    }
    case Op::kPositionCode:
      return input.at(c, y, x) + reference_position_code(input, c, y, x);
    default: {
      size_t i = 0;
      for (; c >= inputs[i]->channels; ++i) c -= inputs[i]->channels;
      return inputs[i]->at(c, y, x);
    }
  }
}

Result<ReferenceKernel> find_kernel(const model::Weights& weights, const std::string& name, size_t in, size_t kernel,
                                    size_t out) {
  const auto weight = weights.find(name + ".weight");
  const auto bias = weights.find(name + ".bias");
  if (weight == weights.end() || bias == weights.end()) {
    return Error{ErrorCode::kNotFound, cat("the weights lack those of ", name, "; use a complete model"), ""};
  }
  E2LF_REQUIRE(weight->second.size() == in * kernel * kernel * out, name + ".weight has another size");
  E2LF_REQUIRE(bias->second.size() == out, name + ".bias has another size");
  return ReferenceKernel{weight->second, bias->second};
}

Planes run_layer(const Layer& layer, const std::vector<const Planes*>& inputs, const Planes* residual,
                 const std::optional<ReferenceKernel>& kernel, Planes output) {
  parallel_for(output.channels * output.height, 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const size_t c = i / output.height;
      const size_t y = i % output.height;
      if (layer.op == Op::kConv) {
        conv_row(*inputs[0], layer, *kernel, c, y, output);
      } else if (layer.op == Op::kConvTransposed) {
        transposed_row(*inputs[0], layer, *kernel, c, y, output);
      } else {
        for (size_t x = 0; x < output.width; ++x) output.at(c, y, x) = element(inputs, layer, c, y, x);
      }
      for (size_t x = 0; x < output.width; ++x) {
        float& value = output.at(c, y, x);
        if (residual != nullptr) value += residual->at(c, y, x);
        if (layer.relu) value = std::max(value, 0.0F);
      }
    }
  });
  return output;
}

Result<Planes> run_cell(const Layer& layer, const Planes& input, const model::Weights& weights, ReferenceState& state) {
  const bool is_gru = layer.op == Op::kConvGru;
  const size_t out = layer.out_channels, joined = input.channels + out;
  E2LF_ASSIGN_OR_RETURN(const ReferenceKernel gates,
                        find_kernel(weights, layer.name + ".gates", joined, layer.kernel, (is_gru ? 2 : 4) * out));
  if (!is_gru) return reference_lstm(layer, input, gates, state);
  E2LF_ASSIGN_OR_RETURN(const ReferenceKernel candidate,
                        find_kernel(weights, layer.name + ".candidate", joined, layer.kernel, out));
  return reference_gru(layer, input, gates, candidate, state);
}

}  // namespace

ReferencePlanes reference_conv(const Planes& input, size_t out_channels, size_t kernel,
                               const ReferenceKernel& weights) {
  Layer layer;
  layer.out_channels = out_channels;
  layer.kernel = kernel;
  return run_layer(layer, {&input}, nullptr, weights, Planes(out_channels, input.height, input.width));
}

Result<std::vector<float>> run_reference(const model::Network& network, const model::Weights& weights,
                                         std::span<const float> input, size_t height, size_t width) {
  ReferenceState at_rest;
  return run_reference(network, weights, input, height, width, at_rest);
}

Result<std::vector<float>> run_reference(const model::Network& network, const model::Weights& weights,
                                         std::span<const float> input, size_t height, size_t width,
                                         ReferenceState& state) {
  E2LF_ASSIGN_OR_RETURN(const auto shapes, model::infer_shapes(network));
  E2LF_REQUIRE(input.size() == network.input_channels * height * width, "the input has another size");
  const size_t multiple = model::size_multiple(network);
  E2LF_REQUIRE(height % multiple == 0 && width % multiple == 0,
               cat("height and width must be multiples of ", multiple));
  std::map<std::string, Planes> tensors;
  tensors.emplace("input", Planes(network.input_channels, height, width))
      .first->second.values.assign(input.begin(), input.end());
  for (size_t i = 0; i < network.layers.size(); ++i) {
    const Layer& layer = network.layers[i];
    std::vector<const Planes*> inputs;
    for (const std::string& name : layer.inputs) inputs.push_back(&tensors.at(name));
    if (layer.op == Op::kPrevious) {
      Planes output(layer.out_channels, height, width);
      output.values = remembered(state, layer.name, output.values.size());
      tensors.emplace(layer.name, std::move(output));
      continue;
    }
    if (model::is_cell(layer)) {
      E2LF_ASSIGN_OR_RETURN(Planes output, run_cell(layer, *inputs[0], weights, state));
      tensors.emplace(layer.name, std::move(output));
      continue;
    }
    if (layer.op == Op::kAttention) {
      tensors.emplace(layer.name, reference_attention(*inputs[0], *inputs[1], *inputs[2], layer.heads));
      continue;
    }
    if (layer.op == Op::kLayerNorm) {
      E2LF_ASSIGN_OR_RETURN(const ReferenceKernel found, find_kernel(weights, layer.name, 1, 1, inputs[0]->channels));
      tensors.emplace(layer.name, reference_layer_norm(*inputs[0], found));
      continue;
    }
    std::optional<ReferenceKernel> kernel;
    if (layer.op == Op::kConv || layer.op == Op::kConvTransposed) {
      E2LF_ASSIGN_OR_RETURN(const ReferenceKernel found,
                            find_kernel(weights, layer.name, inputs[0]->channels, layer.kernel, layer.out_channels));
      kernel.emplace(found);
    }
    const Planes* residual = layer.residual.empty() ? nullptr : &tensors.at(layer.residual);
    Planes output(shapes[i].channels, height / shapes[i].scale, width / shapes[i].scale);
    tensors.emplace(layer.name, run_layer(layer, inputs, residual, kernel, std::move(output)));
  }
  std::vector<float>& result = tensors.at(network.layers.back().name).values;
  for (const Layer& layer : network.layers) {
    if (layer.op == Op::kPrevious) state[layer.name] = result;
  }
  return std::move(result);
}

}  // namespace e2lf::engine
