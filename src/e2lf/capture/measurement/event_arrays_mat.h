// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "e2lf/base/result.h"
#include "e2lf/files/npy.h"

/// Arrays of event images in MATLAB files, which read_event_images() converts.
namespace e2lf::capture {

/// Reads the arrays `events`, `codes`, `camera` and `views` that a .mat file before version 7.3 contains, with their
/// axes in numpy's order: events [cycles, N-1, y, x] or [N-1, y, x], codes [N, view_y, view_x], camera and views
/// [length]. Fails as find_mat_array() does, and with kUnsupported (not real numbers) and kFormat (the number of
/// elements does not match the extents).
[[nodiscard]] Result<NpzArrays> read_event_arrays_mat(const std::filesystem::path& path);

}  // namespace e2lf::capture
