// SPDX-License-Identifier: MIT
// Reads lenslet mosaics; declared in readers.h.
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/lightfield/axes.h"
#include "e2lf/lightfield/formats/readers.h"

namespace e2lf::lightfield {
namespace {

constexpr size_t kLytroViews = 14;

/// Returns the number of views per axis behind a microlens.
Result<size_t> views_behind_lens(const std::filesystem::path& path, const ReadOptions& options) {
  if (options.lenslet_views > 0) return options.lenslet_views;
  if (path.stem().string().ends_with("eslf")) return kLytroViews;
  return Error{ErrorCode::kInvalidValue,
               "a single image is read as a lenslet mosaic; give its number of views per axis, e.g. 14 for a Lytro "
               "camera, or cut views that stand side by side into a folder",
               path.string(), Setting::kLensletViews};
}

}  // namespace

Result<LightField> read_lenslet(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string location = path.string();
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> bytes, read_file(path));
  E2LF_ASSIGN_OR_RETURN(const RawImage mosaic,
                        is_png(bytes) ? decode_png(bytes, location) : decode_jpeg(bytes, location));
  E2LF_ASSIGN_OR_RETURN(const size_t views, views_behind_lens(path, options));
  if (mosaic.width % views != 0 || mosaic.height % views != 0) {
    return fail(ErrorCode::kShape, location, "a mosaic of ", mosaic.width, "x", mosaic.height,
                " samples does not divide into microlenses of ", views, "x", views,
                " views; a single image is read as such a mosaic, give the folder to read views in separate files");
  }
  StoredArray array;
  array.shape = {views, views, mosaic.height / views, mosaic.width / views, mosaic.channels};
  array.strides = huwvc_strides(array.shape);
  array.type = mosaic.sample_bytes == 2 ? SampleType::kUint16 : SampleType::kUint8;
  array.bytes = mosaic.samples;
  return from_stored(array, options, location);
}

}  // namespace e2lf::lightfield
