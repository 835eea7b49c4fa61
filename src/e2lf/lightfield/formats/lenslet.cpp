// SPDX-License-Identifier: MIT
// Reads lenslet mosaics; declared in readers.h.
#include <optional>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/lightfield/formats/readers.h"
#include "e2lf/lightfield/formats/view_grid.h"

namespace e2lf::lightfield {
namespace {

constexpr size_t kLytroViews = 14;

/// Returns the number of views per axis behind a lens that the user or the file name states.
Result<size_t> stated_views(const std::filesystem::path& path, const ReadOptions& options) {
  if (options.lenslet_views > 0) return options.lenslet_views;
  if (path.stem().string().ends_with("eslf")) return kLytroViews;
  return Error{ErrorCode::kInvalidValue,
               "a single image is read as a lenslet mosaic; give its number of views per axis, e.g. 14 for a Lytro "
               "camera, or cut "
               "views that stand side by side into a folder",
               path.string(), "lenslet_views"};
}

/// Refuses a number of views that the user or the file name states if the content shows another layout.
Result<void> check_layout(const RawImage& mosaic, size_t views, const std::string& location) {
  const Picture picture = first_channel(mosaic);
  const std::optional<size_t> found = lenslet_grid(picture);
  if (!found && is_montage(picture, views)) {
    return fail(ErrorCode::kUnsupported, location,
                "the image contains whole views side by side instead of a lenslet mosaic; cut it into a folder of "
                "VV_UU.png (row_column)");
  }
  if (!found || *found == views) return {};
  return Error{ErrorCode::kInvalidValue,
               cat("neighbouring pixels of the mosaic resemble each other behind lenses of ", *found, "x", *found,
                   " views and not of ", views, "x", views, "; give the number of views per axis"),
               location, "lenslet_views"};
}

}  // namespace

Result<LightField> read_lenslet(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string location = path.string();
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> bytes, read_file(path));
  E2LF_ASSIGN_OR_RETURN(const RawImage mosaic,
                        is_png(bytes) ? decode_png(bytes, location) : decode_jpeg(bytes, location));
  E2LF_ASSIGN_OR_RETURN(const size_t views, stated_views(path, options));
  if (mosaic.width % views != 0 || mosaic.height % views != 0) {
    return fail(ErrorCode::kShape, location, "a mosaic of ", mosaic.width, "x", mosaic.height,
                " samples does not divide into microlenses of ", views, "x", views,
                " views; a single image is read as such a mosaic, give the folder to read views in separate files");
  }
  E2LF_RETURN_IF_ERROR(check_layout(mosaic, views, location));
  StoredArray array = stored_view(mosaic);
  array.shape = {views, views, mosaic.height / views, mosaic.width / views, mosaic.channels};
  array.strides = huwvc_strides(array.shape);
  return from_stored(array, options, location);
}

}  // namespace e2lf::lightfield
