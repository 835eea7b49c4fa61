// SPDX-License-Identifier: MIT
// Registers the cameras of the library for a program of tests.
#include "e2lf/cameras/cameras.h"

namespace {
[[maybe_unused]] const bool kHasCameras = (e2lf::cameras::add_cameras(), true);
}
