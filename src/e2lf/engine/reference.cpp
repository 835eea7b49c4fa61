// SPDX-License-Identifier: MIT
#include "e2lf/engine/reference.h"

#include "e2lf/base/result.h"
#include "e2lf/base/threads.h"

namespace e2lf::engine {

float ReferencePlanes::at_or_zero(size_t c, ptrdiff_t y, ptrdiff_t x) const {
  const bool is_inside = y >= 0 && y < static_cast<ptrdiff_t>(height) && x >= 0 && x < static_cast<ptrdiff_t>(width);
  return is_inside ? at(c, static_cast<size_t>(y), static_cast<size_t>(x)) : 0.0F;
}

void ReferencePlanes::fill(const std::function<float(size_t c, size_t y, size_t x)>& value) {
  parallel_for(channels * height, 1, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      for (size_t x = 0; x < width; ++x) values[row * width + x] = value(row / height, row % height, x);
    }
  });
}

Result<ReferenceKernel> ReferenceCall::kernel(const std::string& name, size_t size, size_t out) const {
  const auto weight = weights.find(name + ".weight");
  const auto bias = weights.find(name + ".bias");
  if (weight == weights.end() || bias == weights.end()) {
    return fail(ErrorCode::kNotFound, "", "the weights lack those of ", name, "; use a complete model");
  }
  E2LF_REQUIRE(weight->second.size() == size, name + ".weight has another size");
  E2LF_REQUIRE(bias->second.size() == out, name + ".bias has another size");
  return ReferenceKernel{weight->second, bias->second};
}

std::vector<float>& ReferenceCall::remembered(const std::string& name, size_t size) {
  std::vector<float>& values = state[name];
  if (values.empty()) values.assign(size, 0.0F);
  E2LF_REQUIRE(values.size() == size, "the state belongs to another network or image size");
  return values;
}

ReferencePlanes reference_conv(const ReferencePlanes& input, size_t out_channels, size_t kernel,
                               const ReferenceKernel& weights) {
  ReferencePlanes output(out_channels, input.height, input.width);
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

}  // namespace e2lf::engine
