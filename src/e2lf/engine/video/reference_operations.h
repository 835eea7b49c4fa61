// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "e2lf/engine/reference.h"

/// Internal parts of the reference; not for use by other modules. All of them compute in double precision.
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

/// Returns the state of that name, which is zero at rest. A state of another size breaks the contract.
[[nodiscard]] std::vector<float>& remembered(ReferenceState& state, const std::string& name, size_t size);

/// Computes a "same" convolution with stride 1 and sums in double precision.
[[nodiscard]] ReferencePlanes reference_conv(const ReferencePlanes& input, size_t out_channels, size_t kernel,
                                             const ReferenceKernel& weights);

/// Compute one frame of model::Op::kConvGru and kConvLstm, in double precision except for stored values, and update the
/// state.
[[nodiscard]] ReferencePlanes reference_gru(const model::Layer& layer, const ReferencePlanes& input,
                                            const ReferenceKernel& gates, const ReferenceKernel& candidate,
                                            ReferenceState& state);
[[nodiscard]] ReferencePlanes reference_lstm(const model::Layer& layer, const ReferencePlanes& input,
                                             const ReferenceKernel& gates, ReferenceState& state);

/// Computes model::Op::kAttention.
[[nodiscard]] ReferencePlanes reference_attention(const ReferencePlanes& queries, const ReferencePlanes& keys,
                                                  const ReferencePlanes& values, size_t heads);

/// Computes model::Op::kLayerNorm.
[[nodiscard]] ReferencePlanes reference_layer_norm(const ReferencePlanes& input, const ReferenceKernel& weights);

/// Returns the value that model::Op::kPositionCode adds.
[[nodiscard]] float reference_position_code(const ReferencePlanes& input, size_t c, size_t y, size_t x);

}  // namespace e2lf::engine
