// SPDX-License-Identifier: MIT
// Registers the formats beyond RAW, npz and HDF5 for a program of tests.
#include "e2lf/formats/formats.h"

namespace {
[[maybe_unused]] const bool kAreAdded = (e2lf::formats::add_formats(), true);
}
