// SPDX-License-Identifier: MIT
// Runs networks by plain loops, as the reference for the kernels of the engine.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/model/operation.h"

namespace e2lf::engine {

/// The memory of recurrent layers by names that begin with those of the layers; [channel, y, x] each. If it is empty,
/// the network is at rest.
using ReferenceState = std::map<std::string, std::vector<float>>;

/// A tensor [channel, y, x].
struct ReferencePlanes {
  size_t channels = 0, height = 0, width = 0;
  std::vector<float> values;

  ReferencePlanes(size_t c, size_t h, size_t w) : channels(c), height(h), width(w), values(c * h * w) {}
  [[nodiscard]] float& at(size_t c, size_t y, size_t x) { return values[(c * height + y) * width + x]; }
  [[nodiscard]] float at(size_t c, size_t y, size_t x) const { return values[(c * height + y) * width + x]; }

  /// Returns the value, or zero outside of the image.
  [[nodiscard]] float at_or_zero(size_t c, ptrdiff_t y, ptrdiff_t x) const;

  /// Sets each value, in any order and by several threads.
  void fill(const std::function<float(size_t c, size_t y, size_t x)>& value);
};

struct ReferenceKernel {
  const std::vector<float>& weight;
  const std::vector<float>& bias;
};

/// The evaluation of one layer.
struct ReferenceCall {
  const model::Layer& layer;
  std::vector<const ReferencePlanes*> inputs;
  ReferencePlanes output;  ///< of the shape of the result, to be filled
  const model::Weights& weights;
  ReferenceState& state;

  /// Returns "<name>.weight" and "<name>.bias". Fails with kNotFound; numbers of values other than `size` and `out`
  /// break the contract.
  [[nodiscard]] Result<ReferenceKernel> kernel(const std::string& name, size_t size, size_t out) const;

  /// Returns the state of that name, which is zero at rest. A state of another size breaks the contract.
  [[nodiscard]] std::vector<float>& remembered(const std::string& name, size_t size);
};

inline float ReferencePlanes::at_or_zero(size_t c, ptrdiff_t y, ptrdiff_t x) const {
  const bool is_inside = y >= 0 && y < static_cast<ptrdiff_t>(height) && x >= 0 && x < static_cast<ptrdiff_t>(width);
  return is_inside ? at(c, static_cast<size_t>(y), static_cast<size_t>(x)) : 0.0F;
}

inline void ReferencePlanes::fill(const std::function<float(size_t c, size_t y, size_t x)>& value) {
  parallel_for(channels * height, 1, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      for (size_t x = 0; x < width; ++x) values[row * width + x] = value(row / height, row % height, x);
    }
  });
}

inline Result<ReferenceKernel> ReferenceCall::kernel(const std::string& name, size_t size, size_t out) const {
  const auto weight = weights.find(name + ".weight");
  const auto bias = weights.find(name + ".bias");
  if (weight == weights.end() || bias == weights.end()) {
    return fail(ErrorCode::kNotFound, "", "the weights lack those of ", name, "; use a complete model");
  }
  E2LF_REQUIRE(weight->second.size() == size, name + ".weight has another size");
  E2LF_REQUIRE(bias->second.size() == out, name + ".bias has another size");
  return ReferenceKernel{weight->second, bias->second};
}

inline std::vector<float>& ReferenceCall::remembered(const std::string& name, size_t size) {
  std::vector<float>& values = state[name];
  if (values.empty()) values.assign(size, 0.0F);
  E2LF_REQUIRE(values.size() == size, "the state belongs to another network or image size");
  return values;
}

/// The references of operations beside those of model::Op, by name.
inline std::map<std::string, Result<ReferencePlanes> (*)(ReferenceCall& call)>& added_references() {
  static std::map<std::string, Result<ReferencePlanes> (*)(ReferenceCall & call)> all;
  return all;
}

namespace reference {

using model::Layer;
using model::Op;
using Planes = ReferencePlanes;

/// Adds weight * input, shifted by (dy, dx), to one row of sums. Values outside of the image count as zero.
inline void add_tap(const Planes& input, size_t channel, ptrdiff_t y, ptrdiff_t dx, float weight,
                    std::vector<double>& sums) {
  if (y < 0 || y >= static_cast<ptrdiff_t>(input.height)) return;
  const auto width = static_cast<ptrdiff_t>(input.width);
  const float* row = &input.values[(channel * input.height + static_cast<size_t>(y)) * input.width];
  for (ptrdiff_t x = std::max<ptrdiff_t>(0, -dx); x < std::min(width, width - dx); ++x) {
    sums[static_cast<size_t>(x)] += static_cast<double>(weight) * row[x + dx];
  }
}

inline void conv_row(const Planes& input, const Layer& layer, const ReferenceKernel& kernel, size_t out, size_t y,
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
          sums[x] += static_cast<double>(taps[tap]) * input.at_or_zero(in, in_y, in_x);
        }
      }
    }
  }
  for (size_t x = 0; x < output.width; ++x) output.at(out, y, x) = static_cast<float>(sums[x]);
}

inline void transposed_row(const Planes& input, const Layer& layer, const ReferenceKernel& kernel, size_t out, size_t y,
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

/// Computes a convolution.
inline Result<Planes> convolve(ReferenceCall& call) {
  const Layer& layer = call.layer;
  const Planes& input = *call.inputs[0];
  const size_t size = input.channels * layer.kernel * layer.kernel * layer.out_channels;
  E2LF_ASSIGN_OR_RETURN(const ReferenceKernel kernel, call.kernel(layer.name, size, layer.out_channels));
  Planes& output = call.output;
  parallel_for(output.channels * output.height, 1, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const auto compute = layer.op == Op::kConv ? conv_row : transposed_row;
      compute(input, layer, kernel, row / output.height, row % output.height, output);
    }
  });
  return std::move(output);
}

/// Computes a "same" convolution with stride 1 and sums in double precision.
inline Planes same_conv(const Planes& input, size_t out_channels, size_t kernel, const ReferenceKernel& weights) {
  Planes output(out_channels, input.height, input.width);
  const auto radius = static_cast<ptrdiff_t>(kernel / 2);
  output.fill([&](size_t out, size_t y, size_t x) {
    double sum = weights.bias[out];
    const float* tap = &weights.weight[out * input.channels * kernel * kernel];
    for (size_t in = 0; in < input.channels; ++in) {
      for (ptrdiff_t dy = -radius; dy <= radius; ++dy) {
        for (ptrdiff_t dx = -radius; dx <= radius; ++dx) {
          sum += static_cast<double>(*tap++) *
                 input.at_or_zero(in, static_cast<ptrdiff_t>(y) + dy, static_cast<ptrdiff_t>(x) + dx);
        }
      }
    }
    return static_cast<float>(sum);
  });
  return output;
}

/// Returns the function that computes one element of an operation without weights.
inline std::function<float(size_t c, size_t y, size_t x)> element_of(const ReferenceCall& call) {
  const std::string& op = call.layer.op;
  const Planes& input = *call.inputs[0];
  const size_t s = call.layer.stride;
  if (op == Op::kPixelUnshuffle) {
    return [&input, s](size_t c, size_t y, size_t x) {
      return input.at(c / (s * s), y * s + c % (s * s) / s, x * s + c % s);
    };
  }
  if (op == Op::kPixelShuffle) {
    return [&input, s](size_t c, size_t y, size_t x) { return input.at(c * s * s + y % s * s + x % s, y / s, x / s); };
  }
  if (op == Op::kUpsample) return [&input, s](size_t c, size_t y, size_t x) { return input.at(c, y / s, x / s); };
  if (op == Op::kSigmoid) {
    return [&input](size_t c, size_t y, size_t x) {
      return static_cast<float>(1.0 / (1.0 + std::exp(-static_cast<double>(input.at(c, y, x)))));
    };
  }
  if (op == Op::kAdd || op == Op::kMean) {
    const auto count = op == Op::kMean ? static_cast<float>(call.inputs.size()) : 1.0F;
    return [&inputs = call.inputs, count](size_t c, size_t y, size_t x) {
      float sum = 0.0F;
      for (const Planes* each : inputs) sum += each->at(c, y, x);
      return sum / count;
    };
  }
  return [&inputs = call.inputs](size_t c, size_t y, size_t x) {  // Op::kConcat
    size_t i = 0;
    for (; c >= inputs[i]->channels; ++i) c -= inputs[i]->channels;
    return inputs[i]->at(c, y, x);
  };
}

inline Result<Planes> compute(ReferenceCall& call) {
  const auto added = added_references().find(call.layer.op);
  if (added != added_references().end()) return added->second(call);
  if (call.layer.op == Op::kConv || call.layer.op == Op::kConvTransposed) return convolve(call);
  call.output.fill(element_of(call));
  return std::move(call.output);
}

inline Result<Planes> run_layer(ReferenceCall call, const Planes* residual) {
  E2LF_ASSIGN_OR_RETURN(Planes output, compute(call));
  for (size_t i = 0; i < output.values.size(); ++i) {
    float& value = output.values[i];
    if (residual != nullptr) value += residual->values[i];
    if (call.layer.relu) value = std::max(value, 0.0F);
  }
  return output;
}

}  // namespace reference

/// Runs one frame of a network on a whole image by plain loops with sums in double precision. The input is float32
/// [input_channels, height, width], and the result is [output channels, height, width] at the resolution of the output.
/// The state is carried from frame to frame. Sizes of the image (model::size_multiple()) or of weights that do not fit
/// break the contract. Fails as model::infer_shapes does, and with kNotFound if a weight is missing.
inline Result<std::vector<float>> run_reference(const model::Network& network, const model::Weights& weights,
                                                std::span<const float> input, size_t height, size_t width,
                                                ReferenceState& state) {
  E2LF_ASSIGN_OR_RETURN(const auto shapes, model::infer_shapes(network));
  E2LF_REQUIRE(input.size() == network.input_channels * height * width, "the input has another size");
  const size_t multiple = model::size_multiple(network);
  E2LF_REQUIRE(height % multiple == 0 && width % multiple == 0,
               cat("height and width must be multiples of ", multiple));
  std::map<std::string, ReferencePlanes> tensors;
  tensors.emplace("input", ReferencePlanes(network.input_channels, height, width))
      .first->second.values.assign(input.begin(), input.end());
  for (size_t i = 0; i < network.layers.size(); ++i) {
    const model::Layer& layer = network.layers[i];
    std::vector<const ReferencePlanes*> inputs;
    for (const std::string& name : layer.inputs) inputs.push_back(&tensors.at(name));
    const ReferencePlanes* residual = layer.residual.empty() ? nullptr : &tensors.at(layer.residual);
    const ReferencePlanes output(shapes[i].channels, height / shapes[i].scale, width / shapes[i].scale);
    E2LF_ASSIGN_OR_RETURN(ReferencePlanes result,
                          reference::run_layer({layer, inputs, output, weights, state}, residual));
    tensors.emplace(layer.name, std::move(result));
  }
  std::vector<float>& result = tensors.at(network.layers.back().name).values;
  for (const model::Layer& layer : network.layers) {
    if (model::find_operation(layer.op)->is_last_output) state[layer.name] = result;
  }
  return std::move(result);
}

/// Runs the network at rest.
inline Result<std::vector<float>> run_reference(const model::Network& network, const model::Weights& weights,
                                                std::span<const float> input, size_t height, size_t width) {
  ReferenceState at_rest;
  return run_reference(network, weights, input, height, width, at_rest);
}

}  // namespace e2lf::engine
