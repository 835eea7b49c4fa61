// SPDX-License-Identifier: MIT
#include <array>
#include <zlib.h>

#include "e2lf/base/text.h"
#include "e2lf/lightfield/axes.h"
#include "e2lf/lightfield/formats/hdf5_file.h"
#include "e2lf/lightfield/formats/readers.h"

namespace e2lf::lightfield {
namespace {

constexpr const char* kNames[] = {"LF", "LF_y", "Hr_SAI_y"};

/// A data set and what it says of itself, before its samples are read.
struct OpenedSet {
  Hdf5Id set;
  std::string name;
  std::vector<hsize_t> extents;
};

std::string find_name(hid_t file) {
  for (const char* name : kNames) {
    if (H5Lexists(file, name, H5P_DEFAULT) > 0) return name;
  }
  return "";
}

/// Without the sieve buffer: HDF5 1.10 reads beyond it where a damaged file puts samples past its end.
Hdf5Id open_file(const std::filesystem::path& path) {
  const Hdf5Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_sieve_buf_size(access.get(), 0);
  return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose};
}

Result<OpenedSet> open_set(hid_t file, const std::filesystem::path& path) {
  std::string name = find_name(file);
  if (name.empty()) {
    return Error{ErrorCode::kNotFound, "the file has no data set LF, LF_y or Hr_SAI_y; store the light field as LF_y",
                 path.string()};
  }
  OpenedSet opened{{H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose}, std::move(name), {}};
  const Hdf5Id space(opened.set.valid() ? H5Dget_space(opened.set.get()) : H5I_INVALID_HID, H5Sclose);
  const int rank = space.valid() ? H5Sget_simple_extent_ndims(space.get()) : -1;
  if (rank < 0) {
    return Error{ErrorCode::kFormat, cat("not a readable data set (", hdf5_reason(), "); store it again"),
                 cat(path.string(), ": ", opened.name)};
  }
  opened.extents.resize(static_cast<size_t>(rank));
  H5Sget_simple_extent_dims(space.get(), opened.extents.data(), nullptr);
  return opened;
}

/// Extents and axis order of the three data sets; shape.size() is 0 where they do not fit.
StoredArray arrange(const OpenedSet& opened, const ReadOptions& options) {
  const std::vector<hsize_t>& extents = opened.extents;
  const size_t rank = extents.size();
  StoredArray array;
  if (opened.name == "LF" && (rank == 4 || rank == 5)) {
    const size_t skip = rank - 4;  // the channel, where there is one
    array.shape = {extents[skip + 3], extents[skip + 2], extents[skip + 1], extents[skip], skip ? extents[0] : 1};
    array.strides = matlab_uvhwc_strides(array.shape);
  } else if (opened.name == "LF_y" && rank == 3) {
    const size_t views = views_per_axis(extents[0]);
    array.shape = {views, views, extents[1], extents[2], 1};
    array.strides = uvhwc_strides(array.shape);
  } else if (opened.name == "Hr_SAI_y" && rank == 2) {
    const size_t views = options.patch_views;
    E2LF_REQUIRE(views >= 1, "a patch has one view or more");
    if (extents[0] % views == 0 && extents[1] % views == 0) {
      array.shape = {views, views, extents[1] / views, extents[0] / views, 1};
      array.strides = vwuh_strides(array.shape);
    }
  }
  return array;
}

/// The type to read the samples as: bytes and words as they are, floats of any width as float32.
std::optional<SampleType> sample_type(hid_t set) {
  const Hdf5Id type(H5Dget_type(set), H5Tclose);
  if (!type.valid()) return std::nullopt;
  if (H5Tget_class(type.get()) == H5T_FLOAT) return SampleType::kFloat32;
  if (H5Tget_class(type.get()) != H5T_INTEGER || H5Tget_sign(type.get()) != H5T_SGN_NONE) return std::nullopt;
  if (H5Tget_size(type.get()) == 1) return SampleType::kUint8;
  if (H5Tget_size(type.get()) == 2) return SampleType::kUint16;
  return std::nullopt;
}

hid_t memory_type(SampleType type) {
  if (type == SampleType::kUint8) return H5T_NATIVE_UINT8;
  if (type == SampleType::kUint16) return H5T_NATIVE_UINT16;
  return H5T_NATIVE_FLOAT;
}

/// False when a chunk does not hold as many bytes as the layout says: HDF5 1.10 then reads beyond it. The compressed
/// size of every chunk is looked at, and the first one is inflated, which shows a layout that was damaged.
bool chunks_are_whole(hid_t set, hid_t space, hid_t creation, size_t bytes_each) {
  std::array<hsize_t, H5S_MAX_RANK> extents{};
  const int rank = H5Pget_chunk(creation, H5S_MAX_RANK, extents.data());
  uLongf chunk_bytes = bytes_each;
  for (int axis = 0; axis < rank; ++axis) chunk_bytes *= extents[static_cast<size_t>(axis)];
  const int filters = H5Pget_nfilters(creation);
  hsize_t count = 0;
  if (rank < 1 || filters < 0 || H5Dget_num_chunks(set, space, &count) < 0) return false;
  std::array<hsize_t, H5S_MAX_RANK> offset{};
  hsize_t first_bytes = 0;
  for (hsize_t chunk = count; chunk-- > 0;) {
    unsigned skipped_filters = 0;
    if (H5Dget_chunk_info(set, space, chunk, offset.data(), &skipped_filters, nullptr, &first_bytes) < 0) return false;
    if (skipped_filters != 0 || (filters == 0 && first_bytes != chunk_bytes)) return false;
  }
  if (count == 0 || filters == 0) return true;

  unsigned flags = 0, skipped_filters = 0;
  size_t num_values = 0;
  const H5Z_filter_t last =
      H5Pget_filter2(creation, static_cast<unsigned>(filters) - 1, &flags, &num_values, nullptr, 0, nullptr, nullptr);
  if (last != H5Z_FILTER_DEFLATE || chunk_bytes / 1032 > first_bytes) return false;
  std::vector<uint8_t> packed(first_bytes), whole(chunk_bytes);
  return H5Dread_chunk(set, H5P_DEFAULT, offset.data(), &skipped_filters, packed.data()) >= 0 &&
         uncompress(whole.data(), &chunk_bytes, packed.data(), first_bytes) == Z_OK && chunk_bytes == whole.size();
}

/// False when the file does not store what the extents promise. Unwritten chunks take no space, but a light field has
/// hardly any of these.
bool holds_samples(hid_t set) {
  constexpr double kMaxDeflateRatio = 1032.0;
  const Hdf5Id type(H5Dget_type(set), H5Tclose);
  const Hdf5Id space(H5Dget_space(set), H5Sclose);
  const Hdf5Id creation(H5Dget_create_plist(set), H5Pclose);
  if (!type.valid() || !space.valid() || !creation.valid()) return false;
  const double promised =
      static_cast<double>(H5Sget_simple_extent_npoints(space.get())) * static_cast<double>(H5Tget_size(type.get()));
  const bool chunked = H5Pget_layout(creation.get()) == H5D_CHUNKED;
  return promised <= static_cast<double>(H5Dget_storage_size(set)) * (chunked ? kMaxDeflateRatio : 1.0) &&
         (!chunked || chunks_are_whole(set, space.get(), creation.get(), H5Tget_size(type.get())));
}

std::string extents_text(const std::vector<hsize_t>& extents) {
  return shape_text({extents.begin(), extents.end()});
}

}  // namespace

std::string hdf5_reason() {
  std::string reason = "no reason given";
  // Upward = from the innermost function out, so the first entry is the root.
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned number, const H5E_error2_t* error, void* text) -> herr_t {
        if (number == 0 && error->desc != nullptr) *static_cast<std::string*>(text) = error->desc;
        return 0;
      },
      &reason);
  return reason;
}

bool hdf5_has_light_field(const std::filesystem::path& path) {
  const Hdf5Silence silence;
  const Hdf5Id file = open_file(path);
  return file.valid() && !find_name(file.get()).empty();
}

Result<LightField> read_hdf5(const std::filesystem::path& path, const ReadOptions& options) {
  const Hdf5Silence silence;
  const Hdf5Id file = open_file(path);
  if (!file.valid()) {
    return Error{ErrorCode::kFormat, cat("not a readable HDF5 file (", hdf5_reason(), "); copy it again"),
                 path.string()};
  }
  E2LF_ASSIGN_OR_RETURN(const OpenedSet opened, open_set(file.get(), path));
  const std::string location = cat(path.string(), ": ", opened.name);
  StoredArray array = arrange(opened, options);
  if (array.shape.size() == 0) {
    return Error{ErrorCode::kShape,
                 cat("extents ", extents_text(opened.extents),
                     " do not fit; LF is (U,V,H,W,C), LF_y [views, H, W], Hr_SAI_y [views_x * W, views_y * H]"),
                 location};
  }
  const auto type = sample_type(opened.set.get());
  if (!type) {
    return Error{ErrorCode::kUnsupported, "samples are not of type float, uint8 or uint16; convert them", location};
  }
  array.type = *type;
  E2LF_RETURN_IF_ERROR(check_memory(array.shape, sample_bytes(*type), options, location));

  if (!holds_samples(opened.set.get())) {
    return Error{ErrorCode::kTruncated,
                 "samples are missing, or packed by another filter than deflate; copy or store it again", location};
  }
  std::vector<uint8_t> bytes(array.shape.size() * sample_bytes(*type));
  if (H5Dread(opened.set.get(), memory_type(*type), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0) {
    return Error{ErrorCode::kFormat, cat("the samples cannot be read (", hdf5_reason(), "); copy the file again"),
                 location};
  }
  array.bytes = bytes;
  return from_stored(array, options, location);
}

}  // namespace e2lf::lightfield
