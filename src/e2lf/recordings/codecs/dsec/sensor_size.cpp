// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/dsec/sensor_size.h"

#include <cstdint>
#include <vector>

namespace e2lf::recordings::hdf5_events {
namespace {

constexpr int64_t kWidestPx = 65536;

bool is_number(hid_t type) {
  return H5Tget_class(type) == H5T_INTEGER || H5Tget_class(type) == H5T_FLOAT;
}

/// Returns the one or two numbers of an attribute, or none if it does not exist.
std::vector<int64_t> read_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return {};
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Handle space(H5Aget_space(attribute.get()), H5Sclose), type(H5Aget_type(attribute.get()), H5Tclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space.get());
  if (count < 1 || count > 2 || !is_number(type.get())) return {};
  std::vector<int64_t> numbers(static_cast<size_t>(count));
  if (H5Aread(attribute.get(), H5T_NATIVE_INT64, numbers.data()) < 0) return {};
  return numbers;
}

/// Returns the number in a data set of one element, or none if it does not exist.
std::vector<int64_t> read_scalar(hid_t group, const char* name) {
  if (H5Lexists(group, name, H5P_DEFAULT) <= 0) return {};
  const Handle dataset(H5Dopen2(group, name, H5P_DEFAULT), H5Dclose);
  if (!dataset.valid()) return {};
  const Handle type(H5Dget_type(dataset.get()), H5Tclose);
  const auto storage = e2lf::hdf5::inspect_storage(dataset.get(), name);
  if (!storage || storage->claimed_elements() != 1 || !is_number(type.get()) ||
      !e2lf::hdf5::chunks_are_whole(dataset.get(), *storage)) {
    return {};
  }
  std::vector<int64_t> number(1);
  if (H5Dread(dataset.get(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, number.data()) < 0) return {};
  return number;
}

/// Returns {width, height} as far as a group states them.
std::vector<int64_t> size_in(hid_t group) {
  std::vector<int64_t> size;
  for (const char* name : {"width", "height"}) {
    std::vector<int64_t> number = read_scalar(group, name);
    if (number.empty()) number = read_attribute(group, name);
    if (number.size() == 1) size.push_back(number[0]);
  }
  if (size.size() == 2) return size;
  const std::vector<int64_t> resolution = read_attribute(group, "sensor_resolution");
  return {resolution.rbegin(), resolution.rend()};
}

}  // namespace

void read_sensor_size(hid_t file, const std::string& group, RecordingInfo& info) {
  for (const std::string& place : {group, std::string("/")}) {
    if (place != "/" && H5Lexists(file, place.c_str(), H5P_DEFAULT) <= 0) continue;
    const Handle opened(H5Gopen2(file, place.c_str(), H5P_DEFAULT), H5Gclose);
    if (!opened.valid()) continue;
    const std::vector<int64_t> size = size_in(opened.get());
    if (size.size() != 2 || size[0] < 1 || size[1] < 1 || size[0] > kWidestPx || size[1] > kWidestPx) continue;
    info.width = static_cast<size_t>(size[0]);
    info.height = static_cast<size_t>(size[1]);
    return;
  }
}

}  // namespace e2lf::recordings::hdf5_events
