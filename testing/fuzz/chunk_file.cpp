// SPDX-License-Identifier: MIT
#include "chunk_file.h"

#include <algorithm>
#include <hdf5.h>

#include "e2lf/base/little_endian.h"
#include "e2lf/recordings/codecs/metavision_hdf5/metavision_layout.h"

namespace e2lf::fuzz {
namespace {

using namespace recordings::hdf5_events;

constexpr size_t kMaxChunks = 12;

struct Chunk {
  uint32_t filter_mask = 0;
  std::span<const uint8_t> bytes;
};

std::vector<Chunk> list_chunks(std::span<const uint8_t> input) {
  std::vector<Chunk> chunks;
  while (input.size() > 3 && chunks.size() < kMaxChunks) {
    const size_t size = std::min<size_t>(load_le<uint16_t>(&input[1]), input.size() - 3);
    chunks.push_back({input[0], input.subspan(3, size)});
    input = input.subspan(3 + size);
  }
  return chunks;
}

std::vector<uint8_t> image_of(hid_t file) {
  H5Fflush(file, H5F_SCOPE_GLOBAL);
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  std::vector<uint8_t> bytes(size > 0 ? static_cast<size_t>(size) : 0);
  if (H5Fget_file_image(file, bytes.data(), bytes.size()) != size) bytes.clear();
  return bytes;
}

Handle make_memory_file() {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.get(), size_t{1} << 16, 0);
  return {H5Fcreate("in memory", H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose};
}

/// The time of day is left out, so that one input is one file.
Handle dataset_properties() {
  Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties.get(), false);
  return properties;
}

template <typename T>
void write_column(hid_t parent, const char* name, hid_t type, const T* values, hsize_t count) {
  const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Handle properties = dataset_properties();
  const Handle set(H5Dcreate2(parent, name, type, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), H5Dclose);
  H5Dwrite(set.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
}

}  // namespace

std::vector<uint8_t> make_column_file(const recordings::EventColumns& events) {
  const LibraryLock lock;
  const Handle file = make_memory_file();
  const Handle group(H5Gcreate2(file.get(), "events", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  const hsize_t count = events.size();
  const int64_t offset_us = 1000;
  write_column(group.get(), "x", H5T_NATIVE_UINT16, events.x.data(), count);
  write_column(group.get(), "y", H5T_NATIVE_UINT16, events.y.data(), count);
  write_column(group.get(), "p", H5T_NATIVE_UINT8, events.p.data(), count);
  write_column(group.get(), "t", H5T_NATIVE_INT64, events.t.data(), count);
  write_column(file.get(), "t_offset", H5T_NATIVE_INT64, &offset_us, 1);
  return image_of(file.get());
}

std::vector<uint8_t> make_chunk_file(std::span<const uint8_t> input) {
  if (input.size() < 3) return {};
  constexpr hsize_t kLengths[] = {1, 7, 64, 16384};
  const hsize_t chunk_length = kLengths[input[0] & 3], none = 0, unlimited = H5S_UNLIMITED;
  const hsize_t missing = load_le<uint16_t>(&input[1]) % chunk_length;

  const LibraryLock lock;
  const Handle file = make_memory_file();
  const Handle group(H5Gcreate2(file.get(), "CD", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  const Handle properties = dataset_properties();
  H5Pset_chunk(properties.get(), 1, &chunk_length);
  if ((input[0] & 4) == 0) H5Pset_filter(properties.get(), kEcfFilter, H5Z_FLAG_OPTIONAL, 0, nullptr);
  if ((input[0] & 8) != 0) H5Pset_deflate(properties.get(), 1);
  const Handle space(H5Screate_simple(1, &none, &unlimited), H5Sclose);
  Handle dataset(
      H5Dcreate2(group.get(), "events", event_type().get(), space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
      H5Dclose);
  const std::vector<Chunk> chunks = list_chunks(input.subspan(3));
  if (chunks.empty()) return {};
  // Set once, as the library itself does not shrink a data set of damaged chunks safely.
  const hsize_t extent = chunks.size() * chunk_length - missing;
  H5Dset_extent(dataset.get(), &extent);
  for (size_t i = 0; i < chunks.size(); ++i) {
    const hsize_t offset = i * chunk_length;
    const auto& [filter_mask, bytes] = chunks[i];
    if (!bytes.empty()) H5Dwrite_chunk(dataset.get(), H5P_DEFAULT, filter_mask, &offset, bytes.size(), bytes.data());
  }
  dataset.close();
  return image_of(file.get());
}

}  // namespace e2lf::fuzz
