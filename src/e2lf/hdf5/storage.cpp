// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <zlib.h>

#include "e2lf/base/text.h"
#include "e2lf/hdf5/library.h"

namespace e2lf::hdf5 {
namespace {

/// The highest compression ratio of deflate.
constexpr uint64_t kMaxDeflateRatio = 1032;

uint64_t product(const std::vector<hsize_t>& extents) {
  uint64_t result = 1;
  for (const hsize_t extent : extents) {
    if (__builtin_mul_overflow(result, uint64_t{extent}, &result)) return UINT64_MAX;
  }
  return result;
}

/// Returns the stored size that the data set states, limited to the size of the file.
uint64_t stored_bytes(hid_t dataset) {
  const Handle file(H5Iget_file_id(dataset), H5Fclose);
  hsize_t size = 0;
  if (H5Fget_filesize(file.get(), &size) < 0) return 0;
  return std::min<uint64_t>(H5Dget_storage_size(dataset), size);
}

/// Returns the number of elements for which the file has room.
uint64_t stored_elements(hid_t dataset, const Storage& storage) {
  if (!storage.is_chunked() || storage.filters.empty()) return storage.stored_bytes / storage.bytes_each;
  const Handle space(H5Dget_space(dataset), H5Sclose);
  hsize_t chunks = 0;
  if (H5Dget_num_chunks(dataset, space.get(), &chunks) < 0) return 0;
  uint64_t elements = 0;
  if (__builtin_mul_overflow(uint64_t{chunks}, product(storage.chunk), &elements)) return UINT64_MAX;
  return elements;
}

/// Returns true if `packed` inflates to exactly `bytes` bytes.
bool inflates_to(const std::vector<uint8_t>& packed, uint64_t bytes) {
  std::array<uint8_t, 16384> out;
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return false;
  stream.next_in = const_cast<Bytef*>(packed.data());  // zlib only reads it
  stream.avail_in = static_cast<uInt>(packed.size());
  uint64_t inflated = 0;
  int state = Z_OK;
  while (state == Z_OK && inflated <= bytes) {
    stream.next_out = out.data();
    stream.avail_out = static_cast<uInt>(out.size());
    state = inflate(&stream, Z_NO_FLUSH);
    inflated += out.size() - stream.avail_out;
  }
  inflateEnd(&stream);
  return state == Z_STREAM_END && inflated == bytes;
}

/// Checks a chunk to which all filters were applied and which takes `size` bytes in the file.
bool packed_chunk_is_whole(hid_t dataset, const Storage& storage, const hsize_t* offset, uint64_t size) {
  if (storage.filters.back() != H5Z_FILTER_DEFLATE) return true;
  if (size > kMaxChunkBytes || storage.chunk_bytes / kMaxDeflateRatio > size) return false;
  std::vector<uint8_t> packed(size);
  uint32_t skipped_filters = 0;
  return H5Dread_chunk(dataset, H5P_DEFAULT, offset, &skipped_filters, packed.data()) >= 0 &&
         inflates_to(packed, storage.chunk_bytes);
}

void read_filters(hid_t properties, Storage& storage) {
  const int filters = H5Pget_nfilters(properties);
  for (int i = 0; i < filters; ++i) {
    size_t parameters = 0;
    unsigned flags = 0, config = 0;
    storage.filters.push_back(
        H5Pget_filter2(properties, static_cast<unsigned>(i), &flags, &parameters, nullptr, 0, nullptr, &config));
  }
}

Result<void> read_layout(hid_t properties, Storage& storage, const std::string& location) {
  const H5D_layout_t layout = H5Pget_layout(properties);
  const bool is_elsewhere = layout == H5D_VIRTUAL || H5Pget_external_count(properties) > 0;
  if (layout < 0 || is_elsewhere) {
    return fail(ErrorCode::kUnsupported, location, "the data set lies in other files; store it in this one");
  }
  if (layout != H5D_CHUNKED) return {};
  storage.chunk.resize(storage.extents.size());
  const int rank = static_cast<int>(storage.chunk.size());
  if (rank < 1 || H5Pget_chunk(properties, rank, storage.chunk.data()) != rank) {
    return fail(ErrorCode::kFormat, location, "the chunks of the data set cannot be determined; the file is damaged");
  }
  const uint64_t elements = product(storage.chunk);
  if (elements == 0 || __builtin_mul_overflow(elements, uint64_t{storage.bytes_each}, &storage.chunk_bytes) ||
      storage.chunk_bytes > kMaxChunkBytes) {
    return fail(ErrorCode::kUnsupported, location, "the data set has chunks of ", elements, " elements, more than ",
                kMaxChunkBytes, " bytes; store it in smaller ones");
  }
  return {};
}

}  // namespace

uint64_t Storage::claimed_elements() const {
  return product(extents);
}

Result<Storage> inspect_storage(hid_t dataset, const std::string& location) {
  const LibraryLock lock;
  Storage storage;
  const Handle space(H5Dget_space(dataset), H5Sclose);
  const Handle type(H5Dget_type(dataset), H5Tclose);
  const Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  const int rank = space.valid() ? H5Sget_simple_extent_ndims(space.get()) : -1;
  if (rank < 0 || !type.valid() || !properties.valid()) {
    return fail(ErrorCode::kFormat, location, "not a readable data set (", last_reason(), "); copy the file again");
  }
  storage.extents.resize(static_cast<size_t>(rank));
  H5Sget_simple_extent_dims(space.get(), storage.extents.data(), nullptr);
  storage.bytes_each = H5Tget_size(type.get());
  if (storage.bytes_each == 0 || H5Tdetect_class(type.get(), H5T_VLEN) != 0 || H5Tis_variable_str(type.get()) != 0) {
    return fail(ErrorCode::kUnsupported, location, "the data set's elements are not of one size; store plain numbers");
  }
  if (storage.bytes_each > kMaxElementBytes) {
    return fail(ErrorCode::kUnsupported, location, "the data set's elements are of ", storage.bytes_each,
                " bytes each; store plain numbers");
  }
  E2LF_RETURN_IF_ERROR(read_layout(properties.get(), storage, location));
  read_filters(properties.get(), storage);
  if (storage.filters.size() > 16) {
    return fail(ErrorCode::kUnsupported, location,
                "the data set is packed by more than 16 filters; is the file damaged?");
  }
  storage.stored_bytes = stored_bytes(dataset);
  storage.stored_elements = stored_elements(dataset, storage);
  const bool is_compact = H5Pget_layout(properties.get()) == H5D_COMPACT;
  if (is_compact && storage.stored_elements < storage.claimed_elements()) {
    return fail(ErrorCode::kFormat, location, "the data set stores fewer elements than it claims; the file is damaged");
  }
  return storage;
}

Result<void> check_filters(const Storage& storage, const std::string& location) {
  struct Known {
    H5Z_filter_t number;
    const char* name;
    const char* remedy;
  };
  constexpr const char* kByPython =
      "unpack the file with h5repack where Python's hdf5plugin is installed, or name its folder of plugins in "
      "HDF5_PLUGIN_PATH";
  static constexpr Known kKnown[] = {
      {H5Z_FILTER_SZIP, "szip", "store it by deflate with h5repack"},
      {307, "bzip2", "install the Debian package hdf5-filter-plugin"},
      {32000, "LZF", "install the Debian package hdf5-plugin-lzf"},
      {32001, "Blosc", "install the Debian package hdf5-filter-plugin-blosc-serial"},
      {32004, "LZ4", "install the Debian package hdf5-filter-plugin"},
      {32008, "bitshuffle", "install the Debian package bitshuffle"},
      {32013, "ZFP", "install the Debian package hdf5-filter-plugin-zfp-serial"},
      {32015, "Zstandard", kByPython},
      {32026, "Blosc2", kByPython},
      {36559, "ECF", "install the plugin of the Metavision SDK, or store the events as Metavision does"}};
  const LibraryLock lock;
  for (const H5Z_filter_t filter : storage.filters) {
    if (H5Zfilter_avail(filter) > 0) continue;
    const auto* const known = std::find_if(std::begin(kKnown), std::end(kKnown),
                                           [filter](const Known& candidate) { return candidate.number == filter; });
    const bool is_known = known != std::end(kKnown);
    return fail(ErrorCode::kMissingDependency, location, "the data set is compressed by HDF5 filter ", filter,
                is_known ? cat(" (", known->name, ")") : "", ", which is not installed; ",
                is_known ? known->remedy : kByPython);
  }
  return {};
}

bool chunk_is_whole(hid_t dataset, const Storage& storage, const hsize_t* offset) {
  const LibraryLock lock;
  hsize_t size = 0;
  haddr_t address = 0;
  unsigned skipped_filters = 0;
  if (H5Dget_chunk_info_by_coord(dataset, offset, &skipped_filters, &address, &size) < 0 || size == 0) return false;
  const unsigned all_filters = (1U << storage.filters.size()) - 1;
  if ((skipped_filters & all_filters) == all_filters) return size == storage.chunk_bytes;
  // If only some of the filters were skipped, the size cannot be known. No writer does that.
  return (skipped_filters & all_filters) == 0 && packed_chunk_is_whole(dataset, storage, offset, size);
}

bool chunks_are_whole(hid_t dataset, const Storage& storage) {
  if (!storage.is_chunked()) return true;
  const LibraryLock lock;
  const Handle space(H5Dget_space(dataset), H5Sclose);
  hsize_t chunks = 0;
  if (H5Dget_num_chunks(dataset, space.get(), &chunks) < 0) return false;
  std::vector<hsize_t> offset(storage.chunk.size());
  for (hsize_t i = 0; i < chunks; ++i) {
    unsigned skipped_filters = 0;
    if (H5Dget_chunk_info(dataset, space.get(), i, offset.data(), &skipped_filters, nullptr, nullptr) < 0) return false;
    if (!chunk_is_whole(dataset, storage, offset.data())) return false;
  }
  return true;
}

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
      if (!chunk_is_whole(shape.dataset.get(), shape.storage, offset)) return false;
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
    if (std::string text = text_of_attribute(attribute.get()); !text.empty()) {
      texts.emplace_back(name.data(), std::move(text));
    }
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
  E2LF_ASSIGN_OR_RETURN(shape.storage, inspect_storage(shape.dataset.get(), cat(location, ": ", name)));
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
  E2LF_RETURN_IF_ERROR(check_filters(shape.storage, location));
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

}  // namespace e2lf::hdf5
