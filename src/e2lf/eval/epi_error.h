// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/lightfield/light_field.h"

namespace e2lf::eval {

/// Measures how faithfully the changes from view to view, i.e. the lines of the epipolar plane images, are preserved.
/// With the difference D = L(v + 1) - L(v) between neighbouring views v (in rows and in columns of the aperture):
struct EpiError {
  double rms = 0;       ///< root mean square of D_reconstruction - D_truth over all pixels and pairs
  double relative = 0;  ///< rms / root mean square of D_truth; 0 is perfect, 1 is the same picture in all views
};

/// Compares the view-to-view changes of two light fields of the same shape. `clamp` limits the reconstruction to [0,
/// 1]. An error that is the same in every view does not count. Without neighbouring views, both figures are 0. If the
/// truth does not change from view to view but the reconstruction does, `relative` is infinite. Different shapes break
/// the contract.
[[nodiscard]] EpiError epi_error(const lightfield::LightField& truth, const lightfield::LightField& reconstruction,
                                 bool clamp);

}  // namespace e2lf::eval
