// SPDX-License-Identifier: MIT
// Reads light fields that are one array in a file of numpy, MATLAB or HDF5, and writes those of numpy and HDF5;
// declared in readers.h.
#include <iterator>
#include <optional>
#include <vector>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/mat5.h"
#include "e2lf/files/npy.h"
#include "e2lf/hdf5/library.h"
#include "e2lf/lightfield/formats/readers.h"
#include "e2lf/lightfield/views.h"

namespace e2lf::lightfield {

const NpyArray* find_light_field(const NpzArrays& arrays) {
  for (const char* name : {"light_field", "lightfield", "LF"}) {
    if (const auto found = arrays.find(name); found != arrays.end()) return &found->second;
  }
  if (arrays.size() == 1) return &arrays.begin()->second;
  // Beside it, there may be disparities or parameters, which have fewer axes.
  const NpyArray* only = nullptr;
  for (const auto& [name, array] : arrays) {
    if (array.shape.size() < 4) continue;
    if (only != nullptr) return nullptr;
    only = &array;
  }
  return only;
}

std::optional<Shape> npy_shape(const NpyArray& array) {
  const std::vector<size_t>& extents = array.shape;
  const bool are_event_counts = array.type == "i1" || array.type == "i2";
  if (are_event_counts || element_size(array.type) == 0) return std::nullopt;
  if (extents.size() == 5 && (extents[4] == 1 || extents[4] == 3)) {
    return Shape{extents[0], extents[1], extents[2], extents[3], extents[4]};
  }
  // Four axes that end in 1 or 3 are ambiguous. Two small equal extents in front are taken as a grid of views rather
  // than as a number of views.
  const bool grid = extents.size() == 4 && extents[0] == extents[1] && extents[0] <= 32;
  const bool flat_colour = extents.size() == 4 && !grid && (extents[3] == 1 || extents[3] == 3);
  if (extents.size() == 4 && !flat_colour) return Shape{extents[0], extents[1], extents[2], extents[3], 1};
  if (extents.size() != 3 && !flat_colour) return std::nullopt;
  const size_t views = views_per_axis(extents[0]);
  if (views == 0) return std::nullopt;
  return Shape{views, views, extents[1], extents[2], flat_colour ? extents[3] : 1};
}

Result<LightField> from_npy(const NpyArray& array, const ReadOptions& options, const std::string& location) {
  const std::optional<Shape> shape = npy_shape(array);
  if (!shape) {
    return fail(ErrorCode::kShape, location, "an array ", shape_text(array.shape), " of type ",
                array.type.empty() ? "record" : array.type,
                " is not a light field; store float32 or uint8 [view_y, view_x, y, x] or [view, y, x], colour last");
  }
  const bool may_have_channels = shape->views_x == 3 || shape->views_x == 1;
  if (may_have_channels && shape->views_y > 3 && views_per_axis(shape->views_y) > 0) {
    log_warning(cat(location, ": read as ", shape->views_y, "x", shape->views_x,
                    " views; if the axes are [view, channel, y, x], put the channel last"));
  }
  return from_stored({.shape = *shape,
                      .strides = uvhwc_strides(*shape),
                      .type = array.type,
                      .bytes = array.bytes,
                      .white = white_of_type(array.type)},
                     options, location);
}

Result<LightField> read_mat(const std::filesystem::path& path, const ReadOptions& options) {
  const std::string location = path.string() + ": LF";
  E2LF_ASSIGN_OR_RETURN(const std::vector<uint8_t> file, read_file(path));
  std::vector<std::string> names;
  const Result<MatArray> found = find_mat_array(file, "LF", options.max_bytes, location, names);
  if (!found && found.error().code == ErrorCode::kNotFound) {
    return fail(ErrorCode::kNotFound, path, "the file contains no light field LF, but ",
                names.empty() ? "no variable" : join(names),
                "; save a light field under that name, and events as .csv with the columns t, x, y, p");
  }
  if (!found) return found.error();
  const MatArray& variable = *found;
  if (variable.class_type.empty() || variable.complex) {
    return fail(ErrorCode::kUnsupported, location,
                "not of class double, single, logical or integers of 8 to 32 bits, or complex; convert it");
  }
  const std::vector<size_t>& extents = variable.extents;
  if (extents.size() != 4 && extents.size() != 5) {
    return fail(ErrorCode::kShape, location, "has extents ", shape_text(extents), "; store (U,V,H,W) or (U,V,H,W,C)");
  }
  StoredArray array;
  array.shape = {extents[0], extents[1], extents[2], extents[3], extents.size() == 5 ? extents[4] : 1};
  array.strides = matlab_uvhwc_strides(array.shape);
  array.white = variable.logical ? 1.0F : white_of_type(variable.class_type);
  // MATLAB stores numbers as a smaller type than that of their class if all of them fit.
  array.type = variable.type;
  E2LF_RETURN_IF_ERROR(check_memory(array.shape, element_size(array.type), options, location));
  array.bytes = variable.data;
  if (array.type.empty() || array.bytes.size() != array.num_bytes()) {
    return fail(ErrorCode::kFormat, location, "the samples do not fill ", shape_text(extents), "; save the file again");
  }
  return from_stored(array, options, location);
}

Result<void> write_npy_light_field(const std::filesystem::path& path, const LightFieldView& light_field) {
  const Shape shape = shape_of(light_field);
  std::vector<size_t> extents = {shape.views_y, shape.views_x, shape.height, shape.width};
  if (shape.channels == 3) extents.push_back(3);
  std::vector<float> scratch;
  return write_npy(path, make_npy<float>(std::move(extents), light_field.values(scratch)));
}

namespace {

using hdf5::Handle;

constexpr const char* kPatchName = "Hr_SAI_y";
constexpr const char* kNames[] = {"LF", "LF_y", kPatchName};

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

void arrange_patch(size_t views, const std::vector<hsize_t>& extents, StoredArray& array) {
  array.shape = {views, views, extents[1] / views, extents[0] / views, 1};
  array.strides = vwuh_strides(array.shape);
}

/// Returns the extents and axis order of one of the three data sets; a patch is one view. shape.size() is 0 if they do
/// not fit.
StoredArray arrange(const OpenedSet& opened) {
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
  } else if (opened.name == kPatchName && rank == 2) {
    arrange_patch(1, extents, array);
  }
  return array;
}

/// Divides a patch, which was read as one view, into the views that the options or its content state. Fails with
/// kInvalidValue if neither states them, or if they contradict each other, and with kShape.
Result<void> find_views(const ReadOptions& options, const std::vector<hsize_t>& extents, const std::string& location,
                        StoredArray& array) {
  const std::vector<size_t> possible = possible_grids(extents[0], extents[1]);
  const size_t stated = options.lenslet_views;
  if (stated > 0 && (extents[0] % stated != 0 || extents[1] % stated != 0)) {
    return fail(ErrorCode::kShape, location, "a patch of ", extents[0], "x", extents[1], " does not divide into ",
                stated, "x", stated, " views; give the right number of views per axis");
  }
  std::optional<size_t> found;
  if (possible.size() == 1) {
    found = possible[0];
  } else {
    Picture patch{extents[0], extents[1], {}};  // in the order in which it is stored
    E2LF_ASSIGN_OR_RETURN(patch.values, elements_to_float(array.type, array.bytes, location));
    found = montage_grid(patch);
  }
  if (stated == 0 && !found) {
    return Error{ErrorCode::kInvalidValue,
                 cat("a patch of ", extents[0], "x", extents[1],
                     " may hold different numbers of views, and its content does not show which; give the number of "
                     "views per axis"),
                 location, "lenslet_views"};
  }
  if (stated > 0 && possible.size() > 1 && found && *found != stated) {
    return Error{ErrorCode::kInvalidValue,
                 cat("neighbouring views of the patch resemble each other in a grid of ", *found, "x", *found,
                     " views and not of ", stated, "x", stated, "; give the number of views per axis"),
                 location, "lenslet_views"};
  }
  if (stated == 0 && possible.size() > 1) {
    log_info(cat(location, ": its content shows ", *found, "x", *found, " views"));
  }
  arrange_patch(stated > 0 ? stated : *found, extents, array);
  return {};
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
  StoredArray array = arrange(opened);
  if (array.shape.size() == 0) {
    return fail(
        ErrorCode::kShape, location, "extents ",
        shape_text({opened.storage.extents.begin(), opened.storage.extents.end()}),
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
  if (opened.name == kPatchName) {
    E2LF_RETURN_IF_ERROR(find_views(options, opened.storage.extents, location, array));
  } else if (options.lenslet_views > 0) {
    log_unused_grid(location);
  }
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
