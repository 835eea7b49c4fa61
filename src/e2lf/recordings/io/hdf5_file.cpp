// SPDX-License-Identifier: MIT
#include "e2lf/recordings/io/hdf5_file.h"

#include <algorithm>
#include <array>

#include "e2lf/base/text.h"
#include "e2lf/recordings/io/header_text.h"

namespace e2lf::recordings::hdf5_events {
namespace {

std::string text_of_attribute(hid_t attribute) {
  const Handle type(H5Aget_type(attribute), H5Tclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
  if (!type.valid() || H5Sget_simple_extent_npoints(space.get()) != 1) return "";
  if (H5Tget_class(type.get()) != H5T_STRING) return "";
  if (H5Tis_variable_str(type.get()) > 0) {
    char* text = nullptr;
    if (H5Aread(attribute, type.get(), &text) < 0 || text == nullptr) return "";
    std::string result(text);
    H5free_memory(text);
    return result;
  }
  std::string text(std::min<size_t>(H5Tget_size(type.get()), 65536), '\0');
  if (H5Tget_size(type.get()) > text.size() || H5Aread(attribute, type.get(), text.data()) < 0) return "";
  return text.substr(0, text.find('\0'));
}

/// Returns false if a chunk with some of the elements is not stored completely.
bool chunks_are_whole(const DatasetShape& shape, uint64_t begin, uint64_t count) {
  if (!shape.storage.is_chunked()) return true;
  const uint64_t chunk_columns = shape.storage.chunk.size() == 2 ? shape.storage.chunk[1] : 1;
  for (hsize_t row = begin - begin % shape.chunk_length; row < begin + count; row += shape.chunk_length) {
    for (hsize_t column = 0; column < shape.columns; column += chunk_columns) {
      const hsize_t offset[] = {row, column};
      if (!e2lf::hdf5::chunk_is_whole(shape.dataset.get(), shape.storage, offset)) return false;
    }
  }
  return true;
}

/// Returns true if the fields of records do not overlap, or for other types. The library would copy overlapping fields,
/// which only damaged files have, beyond the record.
bool is_sound_type(hid_t dataset) {
  const Handle type(H5Dget_type(dataset), H5Tclose);
  if (!type.valid()) return false;
  if (H5Tget_class(type.get()) != H5T_COMPOUND) return true;
  std::vector<std::pair<size_t, size_t>> fields;  // begin and end of each
  for (unsigned i = 0; i < static_cast<unsigned>(std::max(0, H5Tget_nmembers(type.get()))); ++i) {
    const Handle field(H5Tget_member_type(type.get(), i), H5Tclose);
    const size_t begin = H5Tget_member_offset(type.get(), i), bytes = field.valid() ? H5Tget_size(field.get()) : 0;
    if (bytes == 0 || bytes > H5Tget_size(type.get())) return false;
    fields.emplace_back(begin, begin + bytes);
  }
  std::sort(fields.begin(), fields.end());
  size_t end = 0;
  for (const auto& [begin, field_end] : fields) {
    if (begin < end || field_end > H5Tget_size(type.get())) return false;
    end = field_end;
  }
  return true;
}

}  // namespace

Result<Handle> open_file(ByteSource& source) {
  const LibraryLock lock;
  Handle file;
  if (!source.path().empty()) {
    file = e2lf::hdf5::open_file(source.path());
  } else {
    E2LF_ASSIGN_OR_RETURN(std::vector<uint8_t> bytes, read_rest(source));
    file = e2lf::hdf5::open_bytes(std::move(bytes));
  }
  if (!file.valid()) {
    return fail(ErrorCode::kFormat, source.name(),
                "the HDF5 library cannot open this file, which is damaged or incomplete; copy it again");
  }
  return file;
}

std::vector<std::pair<std::string, std::string>> read_text_attributes(hid_t object) {
  const LibraryLock lock;
  std::vector<std::pair<std::string, std::string>> texts;
  H5O_info_t info{};
  if (H5Oget_info2(object, &info, H5O_INFO_NUM_ATTRS) < 0) return texts;
  for (hsize_t i = 0; i < std::min<hsize_t>(info.num_attrs, 1000); ++i) {
    const Handle attribute(H5Aopen_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_INC, i, H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose);
    if (!attribute.valid()) continue;
    std::array<char, 256> name{};
    if (H5Aget_name(attribute.get(), name.size(), name.data()) <= 0) continue;
    if (std::string text = text_of_attribute(attribute.get()); !text.empty())
      texts.emplace_back(name.data(), header_text(text));
  }
  return texts;
}

Result<DatasetShape> open_dataset(hid_t file, const std::string& name, const std::string& location, uint64_t columns) {
  const LibraryLock lock;
  DatasetShape shape;
  shape.dataset = Handle(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!shape.dataset.valid()) {
    return fail(ErrorCode::kNotFound, location, "the file has no data set ", name,
                "; it may not be an event recording");
  }
  if (!is_sound_type(shape.dataset.get())) {
    return fail(ErrorCode::kFormat, location, "the fields of data set ", name,
                " overlap: the file is damaged; copy it again");
  }
  E2LF_ASSIGN_OR_RETURN(shape.storage, e2lf::hdf5::inspect_storage(shape.dataset.get(), cat(location, ": ", name)));
  const Storage& storage = shape.storage;
  const std::vector<hsize_t>& extents = storage.extents;
  const bool has_one_dimension = columns == 1 && extents.size() == 1;
  if (!has_one_dimension && !(extents.size() == 2 && extents[1] == columns)) {
    return fail(ErrorCode::kShape, location, "data set ", name, " has the shape ",
                shape_text({extents.begin(), extents.end()}), " and not [events, ", columns,
                "]; store one row for each event");
  }
  shape.columns = columns;
  shape.chunk_length = storage.is_chunked() ? storage.chunk[0] : 0;
  shape.claimed_length = storage.claimed_elements() / columns;
  shape.length = std::min(shape.claimed_length, storage.stored_elements / columns);
  return shape;
}

Result<void> read_elements(const DatasetShape& shape, hid_t memory_type, uint64_t begin, uint64_t count, void* out,
                           const std::string& location) {
  const LibraryLock lock;
  const hid_t dataset = shape.dataset.get();
  E2LF_RETURN_IF_ERROR(e2lf::hdf5::check_filters(shape.storage, location));
  if (!chunks_are_whole(shape, begin, count)) {
    return fail(ErrorCode::kTruncated, location, "elements from ", begin, " on are missing; the file is damaged");
  }
  const Handle file_space(H5Dget_space(dataset), H5Sclose);
  const hsize_t start[] = {begin, 0};
  const hsize_t length[] = {count, shape.columns};
  const Handle memory_space(H5Screate_simple(static_cast<int>(shape.storage.extents.size()), length, nullptr),
                            H5Sclose);
  if (H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start, nullptr, length, nullptr) < 0 ||
      H5Dread(dataset, memory_type, memory_space.get(), file_space.get(), H5P_DEFAULT, out) < 0) {
    return fail(ErrorCode::kIo, location, "the HDF5 library cannot read elements from ", begin,
                " on; the file is damaged");
  }
  return {};
}

}  // namespace e2lf::recordings::hdf5_events
