// SPDX-License-Identifier: MIT
#include "e2lf/base/file.h"
#include "e2lf/base/text.h"
#include "e2lf/lightfield/axes.h"
#include "e2lf/lightfield/formats/raw_image.h"
#include "e2lf/lightfield/formats/readers.h"

namespace e2lf::lightfield {

Result<LightField> read_lenslet(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string location = path.string();
  const size_t views = options.lenslet_views;
  E2LF_REQUIRE(views >= 1, "a microlens has one view or more");
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> bytes, read_file(path));
  E2LF_ASSIGN_OR_RETURN(const RawImage mosaic,
                        is_png(bytes) ? decode_png(bytes, location) : decode_jpeg(bytes, location));
  if (mosaic.width % views != 0 || mosaic.height % views != 0) {
    return Error{ErrorCode::kShape,
                 cat("a mosaic of ", mosaic.width, "x", mosaic.height, " samples does not divide into microlenses of ",
                     views, "x", views,
                     " views; a single picture is read as such a mosaic, views in files of their own lie in a folder"),
                 location};
  }
  StoredArray array;
  array.shape = {views, views, mosaic.height / views, mosaic.width / views, mosaic.channels};
  array.strides = huwvc_strides(array.shape);
  array.type = mosaic.sample_bytes == 2 ? SampleType::kUint16 : SampleType::kUint8;
  array.bytes = mosaic.samples;
  return from_stored(array, options, location);
}

}  // namespace e2lf::lightfield
