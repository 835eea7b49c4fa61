// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/files/npy.h"

namespace e2lf::capture {

/// What a file of measurements holds: one entry per cycle, all of one kind and shape, and what is known of how they
/// came about.
struct MeasurementFile {
  std::vector<Measurement> cycles;
  std::optional<NpyArray> codes;       ///< [N, view_y, view_x]
  std::optional<NpyArray> camera;      ///< see camera_from_npy()
  std::optional<NpyArray> views = {};  ///< how the views come out; see views_from_npy()
};

/// Reads an .npz whose arrays tell the kind: `images` float [cycles, N, y, x] are coded images, `events` int16 [cycles,
/// N-1, y, x] beside `images` [cycles, 1, y, x] a hybrid, `lens_array` float [cycles, y, x] what a lens array gave. All
/// else is read as read_event_images() does. Fails with kShape (axes or sizes that do not fit each other) and
/// kInvalidValue (values that are not finite), and as read_event_images() does.
[[nodiscard]] Result<MeasurementFile> read_measurements(const std::filesystem::path& path);

/// Writes them as read_measurements() says. All cycles must have one kind and shape. Fails with kIo.
[[nodiscard]] Result<void> write_measurements(const std::filesystem::path& path, const MeasurementFile& file);

/// Whether arrays of these names are a measurement with intensity images.
[[nodiscard]] bool holds_images(const NpzArrays& arrays);

}  // namespace e2lf::capture
