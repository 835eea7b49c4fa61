// SPDX-License-Identifier: MIT
#include "e2lf/engine/reference.h"

#include <algorithm>
#include <map>

#include "e2lf/base/contract.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"

namespace e2lf::engine {
namespace {

using model::Layer;
using model::Op;

struct Planes {
  size_t channels = 0, height = 0, width = 0;
  std::vector<float> values;

  Planes(size_t c, size_t h, size_t w) : channels(c), height(h), width(w), values(c * h * w) {}
  [[nodiscard]] float& at(size_t c, size_t y, size_t x) { return values[(c * height + y) * width + x]; }
  [[nodiscard]] float at(size_t c, size_t y, size_t x) const { return values[(c * height + y) * width + x]; }
};

struct Kernel {
  const std::vector<float>& weight;
  const std::vector<float>& bias;
};

/// Adds weight * input, shifted by (dy, dx), to one row of sums; what falls outside counts as zero.
void add_tap(const Planes& input, size_t channel, ptrdiff_t y, ptrdiff_t dx, float weight, std::vector<double>& sums) {
  if (y < 0 || y >= static_cast<ptrdiff_t>(input.height)) return;
  const auto width = static_cast<ptrdiff_t>(input.width);
  const float* row = &input.values[(channel * input.height + static_cast<size_t>(y)) * input.width];
  for (ptrdiff_t x = std::max<ptrdiff_t>(0, -dx); x < std::min(width, width - dx); ++x) {
    sums[static_cast<size_t>(x)] += static_cast<double>(weight) * row[x + dx];
  }
}

void conv_row(const Planes& input, const Layer& layer, const Kernel& kernel, size_t out, size_t y, Planes& output) {
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
        for (size_t x = 0; x < output.width; ++x) {
          sums[x] += static_cast<double>(taps[tap]) * input.at(in, y * k + tap / k, x * k + tap % k);
        }
      }
    }
  }
  for (size_t x = 0; x < output.width; ++x) output.at(out, y, x) = static_cast<float>(sums[x]);
}

void transposed_row(const Planes& input, const Layer& layer, const Kernel& kernel, size_t out, size_t y,
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

/// Every op that moves or adds elements.
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
    case Op::kAdd: {
      float sum = 0.0F;
      for (const Planes* each : inputs) sum += each->at(c, y, x);
      return sum;
    }
    default: {
      size_t i = 0;
      for (; c >= inputs[i]->channels; ++i) c -= inputs[i]->channels;
      return inputs[i]->at(c, y, x);
    }
  }
}

Planes run_layer(const Layer& layer, const std::vector<const Planes*>& inputs, const Planes* residual,
                 const std::optional<Kernel>& kernel, Planes output) {
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

}  // namespace

Result<std::vector<float>> run_reference(const model::Network& network, const model::Weights& weights,
                                         std::span<const float> input, size_t height, size_t width) {
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
    std::optional<Kernel> kernel;
    if (layer.op == Op::kConv || layer.op == Op::kConvTransposed) {
      const auto weight = weights.find(layer.name + ".weight");
      const auto bias = weights.find(layer.name + ".bias");
      if (weight == weights.end() || bias == weights.end()) {
        return Error{ErrorCode::kNotFound, cat("the weights lack those of ", layer.name, "; use a complete model"), ""};
      }
      const size_t taps = inputs[0]->channels * layer.kernel * layer.kernel;
      E2LF_REQUIRE(weight->second.size() == taps * layer.out_channels, layer.name + ".weight has another size");
      E2LF_REQUIRE(bias->second.size() == layer.out_channels, layer.name + ".bias has another size");
      kernel.emplace(Kernel{weight->second, bias->second});
    }
    const Planes* residual = layer.residual.empty() ? nullptr : &tensors.at(layer.residual);
    Planes output(shapes[i].channels, height / shapes[i].scale, width / shapes[i].scale);
    tensors.emplace(layer.name, run_layer(layer, inputs, residual, kernel, std::move(output)));
  }
  return tensors.at(network.layers.back().name).values;
}

}  // namespace e2lf::engine
