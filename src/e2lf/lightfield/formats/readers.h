// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/files/npy.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/lightfield/light_field_io.h"

namespace e2lf::lightfield {

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

/// Decodes an image as decode_image does, but without the conversion to float.
[[nodiscard]] Result<RawImage> decode_raw_image(std::span<const uint8_t> bytes, const std::string& name);

/// Checks the values of a light field against the assumed white, i.e. the stored number that was taken as 1 because
/// none was named (0 = one was named). Fails with kInvalidValue if the integers are those of a smaller type: 0 and 1 in
/// 8 bits, or 0 to 255 in 16 bits.
[[nodiscard]] Result<void> check_values(const LightField& light_field, float assumed_white,
                                        const std::string& location);

/// The distances in elements between neighbours along each axis of a stored light field. Each storage convention of the
/// field has a function below. The letters of the field (U, V, ...) are used only here, because the conventions use
/// them with opposite meanings.
struct AxisStrides {
  size_t view_y = 0, view_x = 0, y = 0, x = 0, channel = 0;
};

/// Returns the strides of row-major [U, V, H, W, C], where U is the view row: LightField itself, BasicLFSR in Python,
/// and [t, s, v, u, c] of LFToolbox.
[[nodiscard]] AxisStrides uvhwc_strides(const Shape& shape);
/// Returns the strides of column-major (U, V, H, W, C), which is a MATLAB array. Read from HDF5, it is row-major [C, W,
/// H, V, U].
[[nodiscard]] AxisStrides matlab_uvhwc_strides(const Shape& shape);
/// Returns the strides of a lenslet mosaic [H, U, W, V, C], in which the views of a pixel lie side by side (ESLF).
[[nodiscard]] AxisStrides huwvc_strides(const Shape& shape);
/// Returns the strides of a transposed grey mosaic of whole views [V, W, U, H]: `Hr_SAI_y` as BasicLFSR stores it.
[[nodiscard]] AxisStrides vwuh_strides(const Shape& shape);

/// Returns n such that num_views = n * n, or 0 if num_views is not a square.
[[nodiscard]] size_t views_per_axis(size_t num_views);

/// Returns the number that is white in samples of this numpy type: 255 in u1, 65535 in u2, 1 in floating-point numbers
/// and truth values, and 0 in other types, which do not determine it.
[[nodiscard]] float white_of_type(std::string_view code);

/// A light field as it is stored: samples in the byte order of this machine and in any axis order. `shape` describes
/// what is stored. `channels` may be any number: with three or more, the first three are red, green and blue; one or
/// two are read as grey.
struct StoredArray {
  Shape shape;
  AxisStrides strides;
  std::string type = "f4";  ///< the numpy code of the samples, such as "u1" or "f8"
  std::span<const uint8_t> bytes;
  float white = 1.0F;  ///< the stored number that means 1 unless ReadOptions names one; 0 = it is not known

  /// Returns the number of bytes that the shape needs.
  [[nodiscard]] size_t num_bytes() const;
};

/// Returns the samples of an image as a light field of one view, which points to them.
[[nodiscard]] StoredArray stored_view(const RawImage& image);

/// The views selected along one axis.
struct ChosenViews {
  size_t first = 0, step = 1, count = 0;
  size_t stored = 0;
  bool reversed = false;

  /// Returns the stored index of a selected view.
  [[nodiscard]] size_t operator[](size_t view) const {
    const size_t index = first + step * view;
    return reversed ? stored - 1 - index : index;
  }
};

struct ChosenGrid {
  ChosenViews y, x;
};

/// Applies options.views_y and views_x to the stored grid of views. Fails with kShape if it has too few views.
[[nodiscard]] Result<ChosenGrid> choose_views(size_t stored_y, size_t stored_x, const ReadOptions& options,
                                              const std::string& location);

/// Fails with kUnsupported if shape.size() samples of `bytes_each` bytes exceed options.max_bytes, and with kShape if
/// an extent is 0. The product cannot overflow.
[[nodiscard]] Result<void> check_memory(const Shape& shape, size_t bytes_each, const ReadOptions& options,
                                        const std::string& location);

/// Converts the selected views of a stored array to `out`, which has their number and size, in colour if it has three
/// channels and otherwise in grey. Fails with kInvalidValue as options.range demands.
[[nodiscard]] Result<void> convert_views(const StoredArray& array, const ChosenGrid& grid, const ReadOptions& options,
                                         const LightFieldOutput& out, const std::string& location);

/// Converts the selected views of a stored array to a light field, in grey or colour according to the options. Fails
/// with kUnsupported if it is not known which number is white, and as read_light_field does.
[[nodiscard]] Result<LightField> from_stored(const StoredArray& array, const ReadOptions& options,
                                             const std::string& location);

// The reader and the writer of each kind of storage. They fail as described at read_light_field and write_light_field.

/// The view images of a folder by the (row, column) in their names; those of kHciFolder contain one number, which is
/// the column of row 0. `kind` is the naming scheme that most of them follow.
struct ViewFiles {
  LightFieldKind kind = LightFieldKind::kViewFolder;
  std::map<std::pair<int, int>, std::filesystem::path> files;
  size_t others = 0;    ///< images that are left out because they are named like other views
  size_t pictures = 0;  ///< images that are left out because their names do not number views
  std::string reading;  ///< says how unusual names were read, if they were
};

/// Lists the images in `folder` whose names number a view. `files` is empty if there are none. Fails with kIo, and with
/// kFormat if two files are the same view.
[[nodiscard]] Result<ViewFiles> list_views(const std::filesystem::path& folder);

/// Returns why a folder without views cannot be read.
[[nodiscard]] std::string no_views_text(const std::filesystem::path& folder);

[[nodiscard]] Result<LightField> read_view_folder(const std::filesystem::path& folder, const ReadOptions& options,
                                                  const ProgressFn& progress);

/// Reads `LF` of a MATLAB file older than version 7.3.
[[nodiscard]] Result<LightField> read_mat(const std::filesystem::path& path, const ReadOptions& options);

/// Returns true if an HDF5 file has one of the data sets that read_hdf5 reads: `LF`, `LF_y` or `Hr_SAI_y`.
[[nodiscard]] bool hdf5_has_light_field(const std::filesystem::path& path);
[[nodiscard]] Result<LightField> read_hdf5(const std::filesystem::path& path, const ReadOptions& options);
/// Writes the luma of the views as `LF_y`.
[[nodiscard]] Result<void> write_hdf5(const std::filesystem::path& path, const LightFieldView& light_field);

/// Warns that ReadOptions::lenslet_views has no effect on a light field whose views are separate.
void log_unused_grid(const std::string& location);

[[nodiscard]] Result<LightField> read_lenslet(const std::filesystem::path& path, const ReadOptions& options);

/// One channel of a picture, [y, x], with values in any unit.
struct Picture {
  size_t height = 0, width = 0;
  std::vector<float> values;

  [[nodiscard]] const float* row(size_t y) const { return values.data() + y * width; }
};

/// Returns the number of views per axis of a picture in which whole views stand side by side: the n from 2 to 32 that
/// divides both sides and for which the picture resembles itself one view further and not one and a half. Returns
/// nothing if this does not distinguish one n from the others.
[[nodiscard]] std::optional<size_t> montage_grid(const Picture& picture);

/// Returns the numbers of views per axis, from 2 to 32, that divide both sides into views of at least 4 px.
[[nodiscard]] std::vector<size_t> possible_grids(size_t height, size_t width);

/// Returns the array of an .npz archive that holds the light field, or null.
[[nodiscard]] const NpyArray* find_light_field(const NpzArrays& arrays);
/// Returns the extents of the light field if the array has the shape and type of one.
[[nodiscard]] std::optional<Shape> npy_shape(const NpyArray& array);
[[nodiscard]] Result<LightField> from_npy(const NpyArray& array, const ReadOptions& options,
                                          const std::string& location);
[[nodiscard]] Result<void> write_npy_light_field(const std::filesystem::path& path, const LightFieldView& light_field);

}  // namespace e2lf::lightfield
