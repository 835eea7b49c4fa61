// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/capture/profile/sensor_profile.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::lightfield {

/// The ways in which a light field can be stored.
enum class LightFieldKind {
  kViewFolder,      ///< folder of VV_UU.png or .jpg, named by row and column with any zero padding
  kHciFolder,       ///< folder of input_Cam000.png ..., numbered row by row; see ReadOptions::view_columns
  kStanfordFolder,  ///< folder of out_RR_CC_-y_-x.png or .jpg, 17x17 views
  kArrayFolder,     ///< folder with lightfield.npy, as written by `e2lf reconstruct --format npy`
  kMat,             ///< MATLAB file older than version 7.3 with `LF` (U,V,H,W) or (U,V,H,W,3 or more)
  kHdf5,            ///< HDF5 file (such as a MATLAB file of version 7.3) with `LF`, `LF_y` or `Hr_SAI_y`
  kLenslet,  ///< one picture that is a lenslet mosaic: the views of each pixel lie side by side. A Lytro ESLF (named
             ///< *_eslf.png) has 14x14
  kNpy,      ///< array [view_y, view_x, y, x] or [view, y, x], each optionally with [channel] at the end
  kNpz,      ///< such an array named `light_field`, `lightfield` or `LF`, or as the only one
};

/// Returns a description of the kind, e.g. "folder of VV_UU.png".
[[nodiscard]] const char* kind_name(LightFieldKind kind);

/// Detects the kind of the light field at `path` from file names and first bytes. Fails with kNotFound, and with
/// kUnsupported if it is not a light field.
[[nodiscard]] Result<LightFieldKind> detect_kind(const std::filesystem::path& path);

/// Describes the pictures in a folder that are stored in a format that is not read (OpenEXR, TIFF, ...), and what to do
/// with them: "64 pictures are stored as .exr; convert them to PNG ...". Returns an empty string if there are none.
[[nodiscard]] std::string unread_pictures_text(const std::filesystem::path& folder);

/// Returns the subfolders cycle_00000, cycle_00001, ... in order, or none if there are none. `e2lf reconstruct` writes
/// the light fields of a recording into such folders.
[[nodiscard]] std::vector<std::filesystem::path> cycle_folders(const std::filesystem::path& folder);

/// The treatment of samples that lie outside of [0, 1] by more than 0.001 once they are divided by ReadOptions::white.
/// Smaller deviations are always clamped, except by kKeep. NaN, infinity and values beyond +-kMostKept are always
/// errors; the latter are integer values for which no white was named.
enum class RangePolicy {
  kRefuse,  ///< fails with an error that names the first one
  kClamp,
  kKeep,  ///< keeps the values; for reconstructions, which are stored unclamped
};

/// The largest magnitude that an unclamped reconstruction may have.
inline constexpr float kMostKept = 16.0F;

/// The stored views to select along one axis: first, first + step, ...
struct AxisViews {
  size_t count = 8;             ///< 0 = all stored views (with this step)
  size_t step = 1;              ///< must be at least 1
  std::optional<size_t> first;  ///< if absent: (stored - ((count - 1) * step + 1)) / 2, rounded down
};

/// The default selects the central 8x8 views, by the rule of BasicLFSR if there is no exact centre: views 0..7 of 9. Of
/// 17 views (Stanford), it selects 4..11; with step 2, it selects 1, 3, ..., 15, which doubles the disparity. Of 14
/// views (Lytro), it selects 3..10.
struct ReadOptions {
  AxisViews views_y, views_x;
  bool reverse_rows = false;  ///< the view rows are stored bottom to top, as in some Stanford scenes, whose disparities
                              ///< otherwise have opposite signs along rows and columns
  capture::Orientation orientation = {};  ///< a reordering of the selected views, in addition to the one in the record
  bool colour = false;                    ///< keeps colour; otherwise converts to grey, see grey_of
  RangePolicy range = RangePolicy::kRefuse;
  float white =
      0.0F;  ///< the stored number that means 1; 0 = the largest of an unsigned 8- or 16-bit type, 1 for other types
  size_t view_columns = 0;                 ///< columns of the grid of a kHciFolder; 0 = a square grid
  size_t lenslet_views = 0;                ///< views per axis of one picture that holds all: a lenslet mosaic, or an
                                           ///< `Hr_SAI_y` patch; 0 = as its name or content states
  uint64_t max_bytes = uint64_t{8} << 30;  ///< limit for the stored array and for the result in memory
};

/// Reads a light field of any kind. The samples are divided by options.white. It logs which views were selected if more
/// are stored, and warns of values and extents that are implausible for a light field. If the
/// record in the folder states that the views are turned or flipped, they are reordered (see stored_orientation()),
/// which is also logged. View images are decoded in parallel. Fails with kNotFound (the path or a view, which is
/// named), kShape (fewer views than requested, views of different sizes, or an array of another shape), kInvalidValue
/// (NaN or out of range), kFormat, kTruncated and kUnsupported (also if it exceeds max_bytes). The location is the
/// file.
[[nodiscard]] Result<LightField> read_light_field(const std::filesystem::path& path, const ReadOptions& options = {},
                                                  const ProgressFn& progress = {});

enum class LightFieldFormat {
  kPng8,   ///< folder of VV_UU.png, round(255 * clamp(value))
  kPng16,  ///< folder of VV_UU.png, round(65535 * clamp(value))
  kNpy,    ///< float32 [view_y, view_x, y, x] or [view_y, view_x, y, x, channel], unclamped
  kHdf5,   ///< .h5 with `LF_y` float32 [view, y, x], unclamped; colour becomes grey
};

/// Parses the name of a format: png, png16, npy or h5. Fails with kInvalidValue.
[[nodiscard]] Result<LightFieldFormat> parse_format(const std::string& word);

/// Returns true if a format is a folder of views.
[[nodiscard]] bool is_folder_format(LightFieldFormat format);

/// Returns the format that the extension of a path implies: .npy, .h5 or .hdf5, or without an extension a folder of
/// 8-bit views. Fails with kUnsupported for other extensions.
[[nodiscard]] Result<LightFieldFormat> format_of_path(const std::filesystem::path& path);

struct WriteOptions {
  LightFieldFormat format = LightFieldFormat::kPng8;
  bool overwrite = false;
};

/// Writes a light field to `path`, a folder or a file depending on the format, which appears either whole or not at
/// all. Views are encoded in parallel. Fails with kExists, kIo, and with kShape or kUnsupported if the format cannot
/// hold the light field.
[[nodiscard]] Result<void> write_light_field(const std::filesystem::path& path, const LightFieldView& light_field,
                                             const WriteOptions& options = {}, const ProgressFn& progress = {});

/// Writes the views in a folder format (is_folder_format()) into an existing folder, e.g. a part of a ResultFolder that
/// holds other results, too.
[[nodiscard]] Result<void> write_views(const std::filesystem::path& folder, const LightFieldView& light_field,
                                       LightFieldFormat format, const ProgressFn& progress = {});

}  // namespace e2lf::lightfield
