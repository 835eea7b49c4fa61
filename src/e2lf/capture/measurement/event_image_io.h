// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/capture/measurement/recorded_setup.h"
#include "e2lf/files/npy.h"

namespace e2lf::capture {

/// The content of a file of measurements: one entry per cycle, all of the same kind and shape.
template <typename Cycle>
struct CyclesFile {
  std::vector<Cycle> cycles;
  RecordedSetup setup = {};
};
using EventImageFile = CyclesFile<EventImages>;

/// Reads event images from
///  - an .npz file with `events` [cycles, N-1, y, x] or [N-1, y, x] (any integer type, or floats with integral values)
///  and optionally `codes`, `camera`, `views` and `findings`;
///  - an .npy file of either shape;
///  - a folder of event_image_00000.npy, ... as the paper's software writes them, [y, x] or [y, x, 1], one per
///  transition.
/// Fails with kInvalidValue (NaN, fractions, or values beyond int16), kShape (images of different sizes), kNotFound (no
/// such file or array, or a missing number in a folder), kUnsupported (another extension), and as setup_from_arrays()
/// and the readers of these formats do.
[[nodiscard]] Result<EventImageFile> read_event_images(const std::filesystem::path& path);

}  // namespace e2lf::capture
