// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/files/npy.h"
#include "e2lf/lightfield/light_field_io.h"

// One reader for each kind of storage. They fail as described at read_light_field.
namespace e2lf::lightfield {

/// The view images of a folder by the (row, column) in their names, see NumberedView. `kind` is the naming scheme that
/// most of them follow.
struct ViewFiles {
  LightFieldKind kind = LightFieldKind::kViewFolder;
  std::map<std::pair<size_t, size_t>, std::filesystem::path> files;
  size_t others = 0;    ///< skipped images that follow another naming scheme
  std::string reading;  ///< says how unusual names were read, if they were
};

/// Lists the images in `folder` whose names number a view. `files` is empty if there are none. Fails with kIo, and with
/// kFormat if two files are the same view.
[[nodiscard]] Result<ViewFiles> list_views(const std::filesystem::path& folder);

[[nodiscard]] Result<LightField> read_view_folder(const std::filesystem::path& folder, const ReadOptions& options,
                                                  const ProgressFn& progress);

/// Reads `LF` of a MATLAB file older than version 7.3.
[[nodiscard]] Result<LightField> read_mat(const std::filesystem::path& path, const ReadOptions& options);

/// Returns true if an HDF5 file has one of the data sets that read_hdf5 reads: `LF`, `LF_y` or `Hr_SAI_y`.
[[nodiscard]] bool hdf5_has_light_field(const std::filesystem::path& path);
[[nodiscard]] Result<LightField> read_hdf5(const std::filesystem::path& path, const ReadOptions& options);

[[nodiscard]] Result<LightField> read_lenslet(const std::filesystem::path& path, const ReadOptions& options);

/// Returns the array of an .npz archive that holds the light field, or null.
[[nodiscard]] const NpyArray* find_light_field(const NpzArrays& arrays);
/// Returns the extents of the light field if the array has the shape and type of one.
[[nodiscard]] std::optional<Shape> npy_shape(const NpyArray& array);
[[nodiscard]] Result<LightField> from_npy(const NpyArray& array, const ReadOptions& options,
                                          const std::string& location);

}  // namespace e2lf::lightfield
