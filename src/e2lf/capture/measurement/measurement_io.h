// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/capture/measurement/measurement.h"

namespace e2lf::capture {

using MeasurementFile = CyclesFile<Measurement>;

/// Reads an .npz file whose arrays determine the kind: `images` float [cycles, N, y, x] are coded images, `events`
/// int16 [cycles, N-1, y, x] together with `images` [cycles, 1, y, x] are a hybrid, and `lens_array` float [cycles, y,
/// x] is the image behind a lens array. All other files are read by read_event_images(). Fails with kShape (axes or
/// sizes that do not match), kInvalidValue (values that are not finite), and as read_event_images() does.
[[nodiscard]] Result<MeasurementFile> read_measurements(const std::filesystem::path& path);

/// Writes measurements in the format that read_measurements() describes. All cycles must have the same kind and shape.
/// Fails with kIo.
[[nodiscard]] Result<void> write_measurements(const std::filesystem::path& path, const MeasurementFile& file);

/// Returns whether the names of the arrays are those of a measurement with intensity images.
[[nodiscard]] bool holds_images(const NpzArrays& arrays);

}  // namespace e2lf::capture
