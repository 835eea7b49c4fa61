// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/files/npy.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field_io.h"

namespace e2lf::lightfield {

/// The columns of the grids of the benchmark: number = 9 * row + column.
inline constexpr size_t kHciColumns = 9;

struct NumberedView {
  LightFieldKind kind;  ///< one of the folder kinds
  size_t row, column;   ///< in kHciFolder, whose names contain one number: row 0 and that number
};

/// Returns whether the extension of a file is that of PNG or JPEG images.
[[nodiscard]] bool is_image_name(const std::filesystem::path& file);

/// Parses the file name of a view. Returns nothing for any other file.
[[nodiscard]] std::optional<NumberedView> parse_view_name(const std::filesystem::path& file);

/// A file name with two numbers, which may be the row and the column of a view: view_0_0.png, r00_c00.png.
struct PairName {
  std::string words;  ///< the name without its numbers, which all views of a light field share: "view_#_#"
  size_t row, column;
  /// Whether the first number is the column, as in x0_y0.png.
  bool is_column_first;
};

/// Parses a file name with two numbers. The first one is the row, unless a letter x, u or c, or a word that begins with
/// col, stands in front of it. Returns nothing for any other file.
[[nodiscard]] std::optional<PairName> parse_pair_name(const std::filesystem::path& file);

/// Returns the PNG name of a view. The camera position in a Stanford name is unknown here and is given as *.
[[nodiscard]] std::string view_name(LightFieldKind kind, size_t row, size_t column);

/// Returns the name of the view with another number, with as many digits and the same extension as `like`, which is a
/// name of kHciFolder.
[[nodiscard]] std::string numbered_view_name(const std::filesystem::path& like, size_t number);

/// An image as a file stores it: rows of samples [y, x, channel] of 8 bits, or of 16 bits in the byte order of this
/// machine.
struct RawImage {
  size_t width = 0, height = 0;
  size_t channels = 1;      ///< 1 or 3
  size_t sample_bytes = 1;  ///< 1 or 2
  std::vector<uint8_t> samples;

  [[nodiscard]] size_t row_bytes() const { return width * channels * sample_bytes; }
};

[[nodiscard]] bool is_png(std::span<const uint8_t> bytes);
[[nodiscard]] bool is_jpeg(std::span<const uint8_t> bytes);

/// Rejects an image size that the file cannot hold, where `least_bytes` is the smallest file size that it needs, and
/// sizes beyond 2^28 pixels. It is called before memory is allocated for the pixels.
[[nodiscard]] Result<void> check_image_size(const RawImage& image, double least_bytes, size_t file_bytes,
                                            const std::string& name);

/// Decode one format as decode_image does, but without the conversion to float.
[[nodiscard]] Result<RawImage> decode_png(std::span<const uint8_t> bytes, const std::string& name);
[[nodiscard]] Result<RawImage> decode_jpeg(std::span<const uint8_t> bytes, const std::string& name);

/// Decodes either format, detected from the first bytes. Fails with kFormat if it is neither.
[[nodiscard]] Result<RawImage> decode_raw_image(std::span<const uint8_t> bytes, const std::string& name);

/// Compresses the rows of `image`. A bilevel PNG has 1 bit per pixel, and its samples are 0 and 1.
[[nodiscard]] Result<std::vector<uint8_t>> encode_png_rows(const RawImage& image, bool is_bilevel = false);

}  // namespace e2lf::lightfield

// The reader and the writer of each kind of storage. They fail as described at read_light_field and write_light_field.
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
/// Writes the luma of the views as `LF_y`.
[[nodiscard]] Result<void> write_hdf5(const std::filesystem::path& path, const LightFieldView& light_field);

[[nodiscard]] Result<LightField> read_lenslet(const std::filesystem::path& path, const ReadOptions& options);

/// Returns the array of an .npz archive that holds the light field, or null.
[[nodiscard]] const NpyArray* find_light_field(const NpzArrays& arrays);
/// Returns the extents of the light field if the array has the shape and type of one.
[[nodiscard]] std::optional<Shape> npy_shape(const NpyArray& array);
[[nodiscard]] Result<LightField> from_npy(const NpyArray& array, const ReadOptions& options,
                                          const std::string& location);
[[nodiscard]] Result<void> write_npy_light_field(const std::filesystem::path& path, const LightFieldView& light_field);

}  // namespace e2lf::lightfield
