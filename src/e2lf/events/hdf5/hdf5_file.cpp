// SPDX-License-Identifier: MIT
#include "e2lf/events/hdf5/hdf5_file.h"

#include <algorithm>
#include <array>

#include "e2lf/base/text.h"

namespace e2lf::events::hdf5 {
namespace {

Error write_error(const std::string& name) {
  return {ErrorCode::kIo, "the HDF5 library could not write; check the disk's free space", name};
}

Handle open_attribute(hid_t object, const std::string& name) {
  return {H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose};
}

std::string text_of_attribute(hid_t attribute) {
  const Handle type(H5Aget_type(attribute), H5Tclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
  if (!type.valid() || H5Tget_class(type.get()) != H5T_STRING || H5Sget_simple_extent_npoints(space.get()) != 1) {
    return "";
  }
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

/// Elements that storage backs: what the header's length is held against.
uint64_t stored_elements(hid_t dataset, uint64_t chunk_length, bool filtered) {
  if (chunk_length == 0 || !filtered) {
    const Handle type(H5Dget_type(dataset), H5Tclose);
    return H5Dget_storage_size(dataset) / std::max<uint64_t>(1, H5Tget_size(type.get()));
  }
  const Handle space(H5Dget_space(dataset), H5Sclose);
  hsize_t chunks = 0;
  if (H5Dget_num_chunks(dataset, space.get(), &chunks) < 0) return 0;
  return chunks * chunk_length;
}

/// False when a chunk that the elements lie in is stored at another length than the layout says: HDF5 1.10 reads beyond
/// it. What filters unpack to is not known before.
bool chunks_are_whole(const DatasetShape& shape, uint64_t begin, uint64_t count) {
  if (shape.chunk_length == 0 || !shape.filters.empty()) return true;
  const Handle type(H5Dget_type(shape.dataset.get()), H5Tclose);
  const uint64_t chunk_bytes = shape.chunk_length * H5Tget_size(type.get());
  for (uint64_t chunk = begin / shape.chunk_length; chunk * shape.chunk_length < begin + count; ++chunk) {
    const hsize_t offset = chunk * shape.chunk_length;
    hsize_t size = 0;
    if (H5Dget_chunk_storage_size(shape.dataset.get(), &offset, &size) < 0 || size != chunk_bytes) return false;
  }
  return true;
}

}  // namespace

std::recursive_mutex& library_mutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

LibraryLock::LibraryLock() : guard_(library_mutex()) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

bool Handle::close() {
  if (!valid()) return true;
  const LibraryLock lock;
  return close_(std::exchange(id_, -1)) >= 0;
}

Result<Handle> open_file(ByteSource& source) {
  const LibraryLock lock;
  Handle file;
  // HDF5 1.10 reads beyond its sieve buffer where a damaged file puts elements past its end.
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_sieve_buf_size(access.get(), 0);
  if (!source.path().empty()) {
    file = Handle(H5Fopen(source.path().c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose);
  } else {
    E2LF_ASSIGN_OR_RETURN(std::vector<uint8_t> bytes, read_rest(source));
    H5Pset_fapl_core(access.get(), size_t{1} << 20, false);
    H5Pset_file_image(access.get(), bytes.data(), bytes.size());
    // The name must not be that of a file.
    file = Handle(H5Fopen((source.name() + " (in memory)").c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose);
  }
  if (!file.valid()) {
    return Error{ErrorCode::kFormat, "the HDF5 library cannot open this file; it is damaged or not complete",
                 source.name()};
  }
  return file;
}

std::string read_text_attribute(hid_t object, const std::string& name) {
  const LibraryLock lock;
  const Handle attribute = open_attribute(object, name);
  return attribute.valid() ? text_of_attribute(attribute.get()) : "";
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
    if (std::string text = text_of_attribute(attribute.get()); !text.empty()) texts.emplace_back(name.data(), text);
  }
  return texts;
}

Result<void> write_text_attribute(hid_t object, const std::string& name, const std::string& text) {
  const LibraryLock lock;
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const char* value = text.c_str();
  if (!attribute.valid() || H5Awrite(attribute.get(), type.get(), &value) < 0) return write_error(name);
  return {};
}

Result<DatasetShape> open_dataset(hid_t file, const std::string& name, const std::string& location) {
  const LibraryLock lock;
  DatasetShape shape;
  shape.dataset = Handle(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!shape.dataset.valid()) {
    return Error{ErrorCode::kNotFound, cat("the file has no data set ", name, "; is it an event recording?"), location};
  }
  const Handle space(H5Dget_space(shape.dataset.get()), H5Sclose);
  hsize_t claimed = 0;
  if (H5Sget_simple_extent_ndims(space.get()) != 1 || H5Sget_simple_extent_dims(space.get(), &claimed, nullptr) != 1) {
    return Error{ErrorCode::kShape, cat("data set ", name, " is not one-dimensional"), location};
  }
  const Handle properties(H5Dget_create_plist(shape.dataset.get()), H5Pclose);
  hsize_t chunk = 0;
  if (H5Pget_layout(properties.get()) == H5D_CHUNKED && H5Pget_chunk(properties.get(), 1, &chunk) == 1) {
    shape.chunk_length = chunk;
  }
  if (shape.chunk_length > kMaxChunkLength) {
    return Error{ErrorCode::kUnsupported,
                 cat("data set ", name, " has chunks of ", chunk, " elements, more than ", kMaxChunkLength), location};
  }
  for (int i = 0; i < H5Pget_nfilters(properties.get()); ++i) {
    size_t parameters = 0;
    unsigned flags = 0, config = 0;
    shape.filters.push_back(
        H5Pget_filter2(properties.get(), static_cast<unsigned>(i), &flags, &parameters, nullptr, 0, nullptr, &config));
  }
  const uint64_t stored = stored_elements(shape.dataset.get(), shape.chunk_length, !shape.filters.empty());
  shape.length = std::min<uint64_t>(claimed, stored);
  shape.is_cut = shape.length < claimed;
  return shape;
}

Result<void> read_elements(const DatasetShape& shape, hid_t memory_type, uint64_t begin, uint64_t count, void* out,
                           const std::string& location) {
  const LibraryLock lock;
  const hid_t dataset = shape.dataset.get();
  if (!chunks_are_whole(shape, begin, count)) {
    return Error{ErrorCode::kTruncated, cat("elements from ", begin, " on are missing; the file is damaged"), location};
  }
  const Handle file_space(H5Dget_space(dataset), H5Sclose);
  const hsize_t start = begin, length = count;
  const Handle memory_space(H5Screate_simple(1, &length, nullptr), H5Sclose);
  if (H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, &start, nullptr, &length, nullptr) < 0 ||
      H5Dread(dataset, memory_type, memory_space.get(), file_space.get(), H5P_DEFAULT, out) < 0) {
    return Error{ErrorCode::kIo,
                 cat("the HDF5 library cannot read elements from ", begin, " on; the file is damaged ",
                     "or its compression filter is not installed"),
                 location};
  }
  return {};
}

Result<GrowingDataset> GrowingDataset::create(hid_t parent, const std::string& name, hid_t file_type,
                                              uint64_t chunk_length, H5Z_filter_t filter) {
  const LibraryLock lock;
  const hsize_t none = 0, unlimited = H5S_UNLIMITED, chunk = chunk_length;
  const Handle space(H5Screate_simple(1, &none, &unlimited), H5Sclose);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(properties.get(), 1, &chunk);
  // Optional: the file can be created and looked at where the filter is not installed.
  if (filter != 0) H5Pset_filter(properties.get(), filter, H5Z_FLAG_OPTIONAL, 0, nullptr);
  GrowingDataset result;
  result.name_ = name;
  result.dataset_ = Handle(
      H5Dcreate2(parent, name.c_str(), file_type, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Dclose);
  if (!result.dataset_.valid()) return write_error(name);
  return result;
}

Result<void> GrowingDataset::append(hid_t memory_type, const void* elements, uint64_t count) {
  if (count == 0) return {};
  const LibraryLock lock;
  const hsize_t start = length_, added = count, total = length_ + count;
  if (H5Dset_extent(dataset_.get(), &total) < 0) return write_error(name_);
  const Handle file_space(H5Dget_space(dataset_.get()), H5Sclose);
  const Handle memory_space(H5Screate_simple(1, &added, nullptr), H5Sclose);
  if (H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, &start, nullptr, &added, nullptr) < 0 ||
      H5Dwrite(dataset_.get(), memory_type, memory_space.get(), file_space.get(), H5P_DEFAULT, elements) < 0) {
    return write_error(name_);
  }
  length_ = total;
  return {};
}

Result<void> GrowingDataset::append_chunk(const std::vector<uint8_t>& bytes, size_t size, uint64_t count,
                                          bool is_filtered) {
  const LibraryLock lock;
  const hsize_t start = length_, total = length_ + count;
  if (H5Dset_extent(dataset_.get(), &total) < 0) return write_error(name_);
  // A bit of the mask set = that filter was not applied.
  const uint32_t filter_mask = is_filtered ? 0 : 1;
  if (H5Dwrite_chunk(dataset_.get(), H5P_DEFAULT, filter_mask, &start, size, bytes.data()) < 0) {
    return write_error(name_);
  }
  length_ = total;
  return {};
}

}  // namespace e2lf::events::hdf5
