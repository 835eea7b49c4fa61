// SPDX-License-Identifier: MIT
#pragma once

#include "e2lf/base/planes.h"

namespace e2lf::capture {

/// The intensities that the sensor receives under each pattern (Eq. 1), divided by the number of views: float32
/// [pattern, y, x], row-major.
using CodedIntensities = Planes<float>;

}  // namespace e2lf::capture
