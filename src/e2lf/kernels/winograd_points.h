// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace e2lf::kernels {

// Winograd's F(4, 3) with the points 0, +-a, +-b and infinity (Lavin and Gray, "Fast algorithms for convolutional
// neural networks", CVPR 2016): y = A^T [(G g) * (B^T x)] for six samples x, three taps g and four outputs y. In two
// dimensions, the transforms are applied to columns and then to rows.
inline constexpr double kWinogradA = 1.0;
inline constexpr double kWinogradB = 2.0;
inline constexpr size_t kWinogradPoints = 6;
inline constexpr size_t kWinogradMatrices = kWinogradPoints * kWinogradPoints;

/// Tiles have 4x4 outputs and are aligned to the corner of the image.
inline constexpr size_t kTileSize = 4;

}  // namespace e2lf::kernels
