// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/capture/profile/orientation.h"
#include "e2lf/lightfield/light_field.h"

namespace e2lf::lightfield {

/// How a light field is stored.
enum class LightFieldKind {
  kViewFolder,      ///< folder of VV_UU.png or .jpg: row_column, any zero padding
  kHciFolder,       ///< folder of input_Cam000.png ...: numbered row by row, see ReadOptions::view_columns
  kStanfordFolder,  ///< folder of out_RR_CC_-y_-x.png or .jpg, 17x17
  kArrayFolder,     ///< folder with lightfield.npy, as `e2lf reconstruct --format npy` writes it
  kMat,             ///< MATLAB file before version 7.3 with `LF` (U,V,H,W) or (U,V,H,W,3 or more)
  kHdf5,            ///< HDF5 file (MATLAB's version 7.3 is one) with `LF`, `LF_y` or `Hr_SAI_y`
  kLenslet,         ///< one picture, a lenslet mosaic: the views of each pixel side by side. Ours say how many views;
                    ///< of a Lytro ESLF (named so, *_eslf.png) it is 14x14
  kNpy,             ///< numbers [view_y, view_x, y, x], [view, y, x], either with [channel] at the end
  kNpz,             ///< the same under `light_field`, `lightfield`, `LF`, or as the only array
};

/// E.g. "folder of VV_UU.png".
[[nodiscard]] const char* kind_name(LightFieldKind kind);

/// Tells what is stored at `path` from file names and first bytes. Fails with kNotFound, and with kUnsupported where it
/// is no light field.
[[nodiscard]] Result<LightFieldKind> detect_kind(const std::filesystem::path& path);

/// The folders cycle_00000 ... in a folder, in order: `e2lf reconstruct` writes the light fields of a recording so.
/// None where there are none.
[[nodiscard]] std::vector<std::filesystem::path> cycle_folders(const std::filesystem::path& folder);

/// What becomes of samples outside [0, 1] by more than 0.001 once they are divided by ReadOptions::white (what is
/// nearer is always clamped in the first two). NaN, infinity, and what is beyond +-kMostKept are always errors: the
/// latter are counts whose white nobody named.
enum class RangePolicy {
  kRefuse,  ///< an error that names the first one
  kClamp,
  kKeep,  ///< for reconstructions, which are stored without a clamp
};

/// The largest magnitude that a reconstruction may have, which is stored without a clamp.
inline constexpr float kMostKept = 16.0F;

/// Which of the stored views to take along one axis: first, first + step, ...
struct AxisViews {
  size_t count = 8;             ///< 0 = all that are stored (with this step)
  size_t step = 1;              ///< at least 1
  std::optional<size_t> first;  ///< absent = (stored - ((count - 1) * step + 1)) / 2, rounded down
};

/// The default takes the central 8x8 views, by BasicLFSR's rule where there is no centre: views 0..7 of 9. Of 17
/// (Stanford) it takes 4..11; step 2 takes 1, 3, ..., 15, twice the disparity. Of 14 (Lytro) it takes 3..10.
struct ReadOptions {
  AxisViews views_y, views_x;
  bool reverse_rows = false;  ///< view rows are stored bottom to top, as in some Stanford scenes: with that, disparity
                              ///< has opposite signs along rows and columns
  capture::Orientation orientation = {};  ///< the views that were taken change places, beyond what a record says
  bool colour = false;                    ///< keep colour; otherwise grey, see grey_of
  RangePolicy range = RangePolicy::kRefuse;
  float white =
      0.0F;  ///< the stored number that is 1; 0 = the largest of an unsigned type of 8 or 16 bits, 1 of others
  size_t view_columns = 0;                 ///< of the grid of a kHciFolder; 0 = found, see find_flat_grid()
  size_t lenslet_views = 0;                ///< views per microlens and axis of a lenslet mosaic; 0 = as it says
  size_t patch_views = 8;                  ///< views per axis of an `Hr_SAI_y` patch
  uint64_t max_bytes = uint64_t{8} << 30;  ///< the most that the stored array or the result may take in memory
};

/// Reads a light field of any kind; samples are divided by options.white. Says on the log which views it took, where
/// more are stored, and warns of values and extents that are hardly those of a light field, see plausible_field.h.
/// Views that the folder's record calls turned or flipped change places (see stored_orientation()), which the log says,
/// too. View images are decoded in parallel. Fails with kNotFound (the path, or a view: named), kShape (fewer views
/// than wanted, views of different sizes, an array of another shape), kInvalidValue (NaN, range), kFormat, kTruncated,
/// kUnsupported (also beyond max_bytes); the location is the file.
[[nodiscard]] Result<LightField> read_light_field(const std::filesystem::path& path, const ReadOptions& options = {},
                                                  const ProgressFn& progress = {});

enum class LightFieldFormat {
  kPng8,      ///< folder of VV_UU.png, round(255 * clamp(value))
  kPng16,     ///< folder of VV_UU.png, round(65535 * clamp(value))
  kHci,       ///< folder of input_CamNNN.png, 8 bits, at most 9 view columns
  kStanford,  ///< folder of out_RR_CC_-y_-x.png, 8 bits; y and x are row and column, since one view step is all we know
  kNpy,       ///< float32 [view_y, view_x, y, x] or [view_y, view_x, y, x, channel], not clamped
  kLenslet,   ///< one 16-bit PNG, sample (y * views_y + view_y, x * views_x + view_x)
  kMat,       ///< MATLAB 6 file, `LF` single (U,V,H,W) or (U,V,H,W,3) as LFToolbox has it, not clamped
  kHdf5,      ///< .h5 with `LF_y` float32 [view, y, x], not clamped; colour becomes grey
};

/// The format of a word: png, png16, hci, stanford, npy, lenslet, mat, h5. Fails with kInvalidValue.
[[nodiscard]] Result<LightFieldFormat> parse_format(const std::string& word);

/// Whether a format is a folder of views.
[[nodiscard]] bool is_folder_format(LightFieldFormat format);

/// The format a path asks for: .npy, .mat, .h5 / .hdf5, .png (lenslet mosaic), else a folder of 8-bit views.
[[nodiscard]] LightFieldFormat format_of_path(const std::filesystem::path& path);

struct WriteOptions {
  LightFieldFormat format = LightFieldFormat::kPng8;
  bool overwrite = false;
};

/// Writes to `path`, a folder or a file as the format says, which appears whole or not at all. Views are encoded in
/// parallel. Fails with kExists, kIo, and kShape or kUnsupported where the format cannot hold the light field.
[[nodiscard]] Result<void> write_light_field(const std::filesystem::path& path, const LightField& light_field,
                                             const WriteOptions& options = {}, const ProgressFn& progress = {});

/// Writes the views of a folder format (is_folder_format()) into a folder that is there, e.g. a part of a ResultFolder
/// that holds other results too.
[[nodiscard]] Result<void> write_views(const std::filesystem::path& folder, const LightField& light_field,
                                       LightFieldFormat format, const ProgressFn& progress = {});

}  // namespace e2lf::lightfield
