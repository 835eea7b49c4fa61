// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/engine/conv.h"

namespace e2lf::engine {

// Winograd's F(4, 3), see kernels/elements.h.
using kernels::kWinogradA, kernels::kWinogradB, kernels::kWinogradMatrices, kernels::kWinogradPoints;

/// The number of tiles that are transformed and multiplied together. With the weights, they should fit into the
/// second-level cache.
inline constexpr size_t kWinogradBlockTiles = 12, kWinogradInt16Tiles = 24;

/// The division of a kernel larger than 3x3 into parts x parts 3x3 kernels, which see copies of the input shifted by
/// multiples of 3 pixels. The copies for one vertical shift form a padded group of channels; all groups together are
/// the depth of the products.
struct WinogradParts {
  size_t parts = 1;
  size_t group = 0;
  [[nodiscard]] size_t depth() const { return parts * group; }
};
[[nodiscard]] WinogradParts winograd_parts(const ConvSpec& spec);

/// Packs the 36 matrices [depth, output channel] of the transformed weights of a stride-1 convolution. Part (py, px) of
/// input channel c is row py * group + px * in_channels + c.
[[nodiscard]] PackedMatrices pack_winograd_weights(const ConvSpec& spec, size_t panel_width);

/// Packs the same matrices with pack_int16(). The weights of the last point, which are the largest, are divided by
/// kInt16LastPoint along each axis.
[[nodiscard]] ScaledWeights pack_winograd_int16(const ConvSpec& spec, size_t panel_width);
inline constexpr float kInt16LastPoint = 4.0F;

/// A transformed value is at most this many times the largest of the values of its tile.
inline constexpr float kMostWinogradGrowth = 100.0F;

}  // namespace e2lf::engine
