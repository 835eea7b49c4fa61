// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "e2lf/base/result.h"
#include "e2lf/files/npy.h"

/// Event images in MATLAB files; event_images.h reads and writes them.
namespace e2lf::capture {

/// The arrays `events`, `codes` and `camera` of a .mat before version 7.3, those that are there, with their axes turned
/// to numpy's order: events [cycles, N-1, y, x] or [N-1, y, x], codes [N, view_y, view_x], camera [length]. Fails as
/// find_mat_array(), and with kUnsupported (no real numbers) and kFormat (numbers that do not fill the extents).
[[nodiscard]] Result<NpzArrays> read_event_arrays_mat(const std::filesystem::path& path);

/// Writes such arrays, with types of 8 to 32 bits or floats. Fails with kIo and as encode_mat().
[[nodiscard]] Result<void> write_event_arrays_mat(const std::filesystem::path& path, const NpzArrays& arrays);

}  // namespace e2lf::capture
