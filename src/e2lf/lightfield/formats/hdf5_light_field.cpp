// SPDX-License-Identifier: MIT
// Reads and writes light fields in HDF5 files; declared in readers.h.
#include <iterator>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/files/elements.h"
#include "e2lf/files/file.h"
#include "e2lf/hdf5/library.h"
#include "e2lf/lightfield/axes.h"
#include "e2lf/lightfield/formats/readers.h"
#include "e2lf/lightfield/views.h"

namespace e2lf::lightfield {
namespace {

using hdf5::Handle;

constexpr const char* kNames[] = {"LF", "LF_y", "Hr_SAI_y"};

/// A data set and its description, before its samples are read.
struct OpenedSet {
  Handle set;
  std::string name;
  hdf5::Storage storage;
};

std::string find_name(hid_t file) {
  for (const char* name : kNames) {
    if (H5Lexists(file, name, H5P_DEFAULT) > 0) return name;
  }
  return "";
}

Result<OpenedSet> open_set(hid_t file, const std::filesystem::path& path) {
  std::string name = find_name(file);
  if (name.empty()) {
    return fail(ErrorCode::kNotFound, path,
                "the file has no data set LF, LF_y or Hr_SAI_y; store the light field as LF_y");
  }
  OpenedSet opened{{H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose}, std::move(name), {}};
  const std::string location = cat(path.string(), ": ", opened.name);
  if (!opened.set.valid()) {
    return fail(ErrorCode::kFormat, location, "not a readable data set (", hdf5::last_reason(), "); store it again");
  }
  E2LF_ASSIGN_OR_RETURN(opened.storage, hdf5::inspect_storage(opened.set.get(), location));
  return opened;
}

/// Returns true if `LF` is [U, V, H, W, C] as written by Python, and false if it is MATLAB's array, which is read as
/// [C, W, H, V, U]. MATLAB marks its arrays. For others, the test assumes that views are wider than there are views.
bool is_numpy_order(hid_t set, const std::vector<hsize_t>& extents) {
  if (H5Aexists(set, "MATLAB_class") > 0) return false;
  return extents.size() == 5 ? extents[1] < extents[3] : extents[0] < extents[3];
}

/// Returns the extents and axis order of one of the three data sets. shape.size() is 0 if they do not fit.
StoredArray arrange(const OpenedSet& opened, const ReadOptions& options) {
  const std::vector<hsize_t>& extents = opened.storage.extents;
  const size_t rank = extents.size();
  StoredArray array;
  if (opened.name == "LF" && (rank == 4 || rank == 5)) {
    const size_t skip = rank - 4;  // the channel, where there is one
    if (is_numpy_order(opened.set.get(), extents)) {
      array.shape = {extents[0], extents[1], extents[2], extents[3], skip ? extents[4] : 1};
      array.strides = uvhwc_strides(array.shape);
      return array;
    }
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

/// Returns true if the numbers are true (1) and false (0). MATLAB marks them as logical, and numpy stores an
/// enumeration of two members.
bool is_logical(hid_t set) {
  const Handle type(H5Dget_type(set), H5Tclose);
  if (type.valid() && H5Tget_class(type.get()) == H5T_ENUM && H5Tget_nmembers(type.get()) == 2) return true;
  if (H5Aexists(set, "MATLAB_class") <= 0) return false;
  const Handle attribute(H5Aopen(set, "MATLAB_class", H5P_DEFAULT), H5Aclose);
  const Handle text(attribute.valid() ? H5Aget_type(attribute.get()) : -1, H5Tclose);
  if (!text.valid() || H5Tget_class(text.get()) != H5T_STRING || H5Tis_variable_str(text.get()) > 0) return false;
  std::string name(H5Tget_size(text.get()), '\0');
  return name.size() < 64 && H5Aread(attribute.get(), text.get(), name.data()) >= 0 && name.starts_with("logical");
}

/// Sets the type to read the samples as and the number that is white: 8- and 16-bit unsigned integers unchanged, other
/// numbers as float32. Returns false if they are not numbers.
bool set_type(hid_t set, StoredArray& array) {
  const Handle type(H5Dget_type(set), H5Tclose);
  if (!type.valid()) return false;
  if (H5Tget_class(type.get()) == H5T_FLOAT || is_logical(set)) return true;
  const size_t bytes = H5Tget_size(type.get());
  const bool is_pixel_type = H5Tget_sign(type.get()) == H5T_SGN_NONE && bytes <= 2;
  array.type = is_pixel_type ? cat("u", bytes) : "f4";
  array.white = is_pixel_type ? white_of_type(array.type) : 0.0F;
  return H5Tget_class(type.get()) == H5T_INTEGER;
}

hid_t memory_type(const std::string& code) {
  return code == "u1" ? H5T_NATIVE_UINT8 : code == "u2" ? H5T_NATIVE_UINT16 : H5T_NATIVE_FLOAT;
}

/// Returns false if the file stores fewer samples than the extents claim, or if it compresses them by a filter whose
/// output size is unknown. Chunks that were never written take no space, but light fields have hardly any of these.
bool holds_samples(hid_t set, const hdf5::Storage& storage) {
  constexpr double kMaxDeflateRatio = 1032.0;
  const double promised = static_cast<double>(storage.claimed_elements()) * static_cast<double>(storage.bytes_each);
  const double most = static_cast<double>(storage.stored_bytes) * (storage.is_chunked() ? kMaxDeflateRatio : 1.0);
  const bool is_known = storage.filters.empty() || storage.filters.back() == H5Z_FILTER_DEFLATE;
  return promised <= most && is_known && hdf5::chunks_are_whole(set, storage);
}

std::string extents_text(const std::vector<hsize_t>& extents) {
  return shape_text({extents.begin(), extents.end()});
}

}  // namespace

bool hdf5_has_light_field(const std::filesystem::path& path) {
  const hdf5::LibraryLock lock;
  const Handle file = hdf5::open_file(path);
  return file.valid() && !find_name(file.get()).empty();
}

Result<LightField> read_hdf5(const std::filesystem::path& path, const ReadOptions& options) {
  const hdf5::LibraryLock lock;
  const Handle file = hdf5::open_file(path);
  if (!file.valid()) {
    return fail(ErrorCode::kFormat, path, "not a readable HDF5 file (", hdf5::last_reason(), "); copy it again");
  }
  E2LF_ASSIGN_OR_RETURN(const OpenedSet opened, open_set(file.get(), path));
  const std::string location = cat(path.string(), ": ", opened.name);
  StoredArray array = arrange(opened, options);
  if (array.shape.size() == 0) {
    return fail(
        ErrorCode::kShape, location, "extents ", extents_text(opened.storage.extents),
        " do not fit; LF is (U,V,H,W,C) or [U,V,H,W,C], LF_y [views, H, W], Hr_SAI_y [views_x * W, views_y * H]");
  }
  if (!set_type(opened.set.get(), array)) {
    return fail(ErrorCode::kUnsupported, location, "the samples are not numbers; store float, uint8 or uint16");
  }
  E2LF_RETURN_IF_ERROR(check_memory(array.shape, element_size(array.type), options, location));

  E2LF_RETURN_IF_ERROR(hdf5::check_filters(opened.storage, location));
  if (!holds_samples(opened.set.get(), opened.storage)) {
    return fail(ErrorCode::kTruncated, location,
                "samples are missing, or packed by another filter than deflate; copy or store it again");
  }
  std::vector<uint8_t> bytes(array.num_bytes());
  if (H5Dread(opened.set.get(), memory_type(array.type), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0) {
    return fail(ErrorCode::kFormat, location, "the samples cannot be read (", hdf5::last_reason(),
                "); copy the file again");
  }
  array.bytes = bytes;
  return from_stored(array, options, location);
}

Result<void> write_hdf5(const std::filesystem::path& path, const LightFieldView& light_field) {
  const Shape shape = shape_of(light_field);
  if (shape.channels != 1) return write_hdf5(path, to_grey(light_field));
  std::vector<float> scratch;
  const auto values = light_field.values(scratch);
  const hsize_t extents[] = {shape.num_views(), shape.height, shape.width};
  const hdf5::LibraryLock lock;
  E2LF_ASSIGN_OR_RETURN(AtomicFile target, AtomicFile::create(path));
  E2LF_ASSIGN_OR_RETURN(hdf5::CheckedFile file, hdf5::CheckedFile::create(target.path(), path.string()));
  {
    const Handle space(H5Screate_simple(std::size(extents), extents, nullptr), H5Sclose);
    const Handle set(H5Dcreate2(file.get(), "LF_y", H5T_IEEE_F32LE, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Dclose);
    if (!set.valid() || H5Dwrite(set.get(), H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
      return fail(ErrorCode::kInternal, path, "HDF5 could not encode LF_y (", hdf5::last_reason(),
                  "); write npy instead");
    }
  }
  E2LF_RETURN_IF_ERROR(file.close());
  return target.commit();
}

}  // namespace e2lf::lightfield
