// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "e2lf/engine/reference.h"

/// Parts of the reference; not for other modules.
namespace e2lf::engine {

/// A tensor [channel, y, x].
struct ReferencePlanes {
  size_t channels = 0, height = 0, width = 0;
  std::vector<float> values;

  ReferencePlanes(size_t c, size_t h, size_t w) : channels(c), height(h), width(w), values(c * h * w) {}
  [[nodiscard]] float& at(size_t c, size_t y, size_t x) { return values[(c * height + y) * width + x]; }
  [[nodiscard]] float at(size_t c, size_t y, size_t x) const { return values[(c * height + y) * width + x]; }
};

struct ReferenceKernel {
  const std::vector<float>& weight;
  const std::vector<float>& bias;
};

/// What is remembered under a name; zeros at rest. Of another size it breaks the contract.
[[nodiscard]] std::vector<float>& remembered(ReferenceState& state, const std::string& name, size_t size);

/// "Same" convolution at stride 1, sums in double precision.
[[nodiscard]] ReferencePlanes reference_conv(const ReferencePlanes& input, size_t out_channels, size_t kernel,
                                             const ReferenceKernel& weights);

/// One frame of model::Op::kConvGru and kConvLstm, in double precision but for what is stored; replaces the state.
[[nodiscard]] ReferencePlanes reference_gru(const model::Layer& layer, const ReferencePlanes& input,
                                            const ReferenceKernel& gates, const ReferenceKernel& candidate,
                                            ReferenceState& state);
[[nodiscard]] ReferencePlanes reference_lstm(const model::Layer& layer, const ReferencePlanes& input,
                                             const ReferenceKernel& gates, ReferenceState& state);

}  // namespace e2lf::engine
