// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/files/npy.h"

namespace e2lf::capture {

/// The content of a file of measurements: one entry per cycle, all of the same kind and shape, and the properties of
/// the camera that are known.
struct MeasurementFile {
  std::vector<Measurement> cycles;
  std::optional<NpyArray> codes;       ///< [N, view_y, view_x]
  std::optional<NpyArray> camera;      ///< see camera_from_npy()
  std::optional<NpyArray> views = {};  ///< the orientation of the views; see views_from_npy()
};

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
