// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/engine/operation.h"

namespace e2lf::geometry {

/// The names of the operations that networks with an explicit geometry have beside those of model::Op.
struct GeometryOp : model::Op {
  /// Compares P pictures of G features at each of K disparities. The input has channel p G + g. Picture p lies at
  /// `offsets` [2 p] (row) and [2 p + 1] (column), in view steps. For each disparity d of `disparities`, it is read at
  /// its offset times d, linearly and with zeros outside. For the sums t of the pictures of a feature and q of their
  /// squares, C and E are the means of (t^2 - q) / 2 and of q over the features and over a window of `kernel` (odd)
  /// with zeros outside; the result is C / (1 + E).
  static constexpr const char* kPlaneSweep = "plane-sweep";
  /// Renders K planes to views. The input has the opacity of each plane before a sigmoid, and then the intensity of
  /// each plane. The last plane is opaque. `disparities` are those of the planes from front to back, and `rows` and
  /// `columns` the viewpoints along each axis relative to the central one, in view steps; view r C + c is that of row r
  /// and column c. A plane is read at -viewpoint times its disparity by cubic interpolation (Keys, a = -1/2), with
  /// edges repeated.
  static constexpr const char* kRenderLayers = "render-layers";
  /// Moves P pictures to the reference view. The first input has channel g P + p for feature g of picture p, and the
  /// first channel of the second input is the disparity of the reference view. Picture p is read at `offsets` [2 p]
  /// (row) and [2 p + 1] (column), in view steps, times the disparity, which is limited to `disparities` [least, most],
  /// by linear interpolation with edges repeated.
  static constexpr const char* kWarp = "warp";
};

/// Adds these operations to the process, unless they are there. Programs that use a recon::Reconstructor need no call;
/// others call it before they read models with them.
void add_operations();

// The operations, one for each file.
[[nodiscard]] engine::Operation plane_sweep();
[[nodiscard]] engine::Operation render_layers();
[[nodiscard]] engine::Operation warp();

}  // namespace e2lf::geometry
