// SPDX-License-Identifier: MIT
// Reads lenslet mosaics; declared in readers.h.
#include <charconv>
#include <optional>
#include <string_view>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/lightfield/axes.h"
#include "e2lf/lightfield/formats/raw_image.h"
#include "e2lf/lightfield/formats/readers.h"

namespace e2lf::lightfield {
namespace {

constexpr size_t kLytroViews = 14;

/// The number of views behind a microlens.
struct Grid {
  size_t views_y = 0, views_x = 0;
};

/// Parses "8x8" (rows x columns), as write_light_field stores it in a PNG.
std::optional<Grid> parse_grid(std::string_view text) {
  Grid grid;
  const char* const end = text.data() + text.size();
  const auto [after, error] = std::from_chars(text.data(), end, grid.views_y);
  if (error != std::errc() || after == end || *after != 'x') return std::nullopt;
  const auto [last, second_error] = std::from_chars(after + 1, end, grid.views_x);
  if (second_error != std::errc() || last != end || grid.views_y == 0 || grid.views_x == 0) return std::nullopt;
  return grid;
}

Result<Grid> grid_of(const std::filesystem::path& path, const RawImage& mosaic, const ReadOptions& options) {
  if (options.lenslet_views > 0) return Grid{options.lenslet_views, options.lenslet_views};
  if (const auto stated = parse_grid(mosaic.view_grid)) return *stated;
  if (path.stem().string().ends_with("eslf")) return Grid{kLytroViews, kLytroViews};
  return Error{
      ErrorCode::kInvalidValue,
      "a single image is read as a lenslet mosaic, but this one does not state its number of views; give the number of "
      "views per axis, e.g. 14 for a Lytro camera, or give a folder of views",
      path.string(), Setting::kLensletViews};
}

}  // namespace

Result<LightField> read_lenslet(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string location = path.string();
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> bytes, read_file(path));
  E2LF_ASSIGN_OR_RETURN(const RawImage mosaic,
                        is_png(bytes) ? decode_png(bytes, location) : decode_jpeg(bytes, location));
  E2LF_ASSIGN_OR_RETURN(const Grid grid, grid_of(path, mosaic, options));
  if (mosaic.width % grid.views_x != 0 || mosaic.height % grid.views_y != 0) {
    return Error{
        ErrorCode::kShape,
        cat("a mosaic of ", mosaic.width, "x", mosaic.height, " samples does not divide into microlenses of ",
            grid.views_y, "x", grid.views_x,
            " views; a single image is read as such a mosaic, give the folder to read views in separate files"),
        location};
  }
  StoredArray array;
  array.shape = {grid.views_y, grid.views_x, mosaic.height / grid.views_y, mosaic.width / grid.views_x,
                 mosaic.channels};
  array.strides = huwvc_strides(array.shape);
  array.type = mosaic.sample_bytes == 2 ? SampleType::kUint16 : SampleType::kUint8;
  array.bytes = mosaic.samples;
  return from_stored(array, options, location);
}

}  // namespace e2lf::lightfield
