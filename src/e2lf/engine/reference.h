// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/model/network.h"

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

/// Computes a "same" convolution with stride 1 and sums in double precision.
[[nodiscard]] ReferencePlanes reference_conv(const ReferencePlanes& input, size_t out_channels, size_t kernel,
                                             const ReferenceKernel& weights);

}  // namespace e2lf::engine
