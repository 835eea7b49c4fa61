// SPDX-License-Identifier: MIT
#include "e2lf/formats/dsec/event_places.h"

#include <algorithm>
#include <cstdint>

#include "e2lf/base/text.h"
#include "e2lf/formats/table/layout.h"

namespace e2lf::recordings::hdf5_events::dsec {
namespace {

constexpr int kDeepest = 8;
constexpr size_t kMostObjects = 10'000;

std::string path_in(const std::string& group, const std::string& name) {
  return group.empty() ? name : cat(group, "/", name);
}

struct Object {
  std::string name;
  bool is_group = false;
};

/// Returns the groups and data sets of a group ("" = the root), without links to other files.
std::vector<Object> members_of(hid_t file, const std::string& group, size_t& num_left) {
  std::vector<Object> members;
  const Handle opened(H5Gopen2(file, group.empty() ? "/" : group.c_str(), H5P_DEFAULT), H5Gclose);
  H5G_info_t about{};
  if (!opened.valid() || H5Gget_info(opened.get(), &about) < 0) return members;
  for (hsize_t i = 0; i < about.nlinks && num_left > 0; ++i, --num_left) {
    std::array<char, 256> name{};
    H5L_info_t link{};
    if (H5Lget_name_by_idx(opened.get(), ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT) <=
            0 ||
        H5Lget_info(opened.get(), name.data(), &link, H5P_DEFAULT) < 0 || link.type == H5L_TYPE_EXTERNAL) {
      continue;
    }
    H5O_info_t object{};
    if (H5Oget_info_by_name2(opened.get(), name.data(), &object, H5O_INFO_BASIC, H5P_DEFAULT) < 0) continue;
    if (object.type == H5O_TYPE_GROUP || object.type == H5O_TYPE_DATASET) {
      members.push_back({name.data(), object.type == H5O_TYPE_GROUP});
    }
  }
  return members;
}

/// The names of x, y, p and t, or empty names if one is missing.
using FieldNames = std::array<std::string, table::kNumFields>;

FieldNames field_names(const std::vector<std::string>& names) {
  const table::KnownColumns known = table::find_fields(names);
  if (!table::are_complete(known)) return {};
  return {names[*known[0]], names[*known[1]], names[*known[2]], names[*known[3]]};
}

/// Returns the names of the fields x, y, p and t of records, or empty names if a data set has none.
FieldNames fields_of_records(hid_t dataset) {
  const Handle type(H5Dget_type(dataset), H5Tclose);
  if (!type.valid() || H5Tget_class(type.get()) != H5T_COMPOUND) return {};
  std::vector<std::string> names;
  for (unsigned i = 0; i < static_cast<unsigned>(std::max(0, H5Tget_nmembers(type.get()))); ++i) {
    char* const name = H5Tget_member_name(type.get(), i);
    if (name != nullptr) names.emplace_back(name);
    H5free_memory(name);
  }
  return field_names(names);
}

class Search {
 public:
  explicit Search(hid_t file) : file_(file) {}

  void look_into(const std::string& group, int depth) {
    const std::vector<Object> members = members_of(file_, group, num_left_);
    std::vector<std::string> datasets;
    for (const Object& member : members) {
      if (!member.is_group) datasets.push_back(member.name);
    }
    FieldNames names = field_names(datasets);
    const bool is_usual = group == "events" || group.empty();
    if (!names[0].empty()) {
      for (std::string& name : names) name = path_in(group, name);
      add({group.empty() ? "/" : group, names, "", {}}, is_usual);
    } else {
      for (const Object& member : members) {
        if (!member.is_group) look_at_rows(group, member.name);
      }
    }
    for (const Object& member : members) {
      if (member.is_group && depth < kDeepest) look_into(path_in(group, member.name), depth + 1);
    }
  }

  std::vector<EventPlace> places;

 private:
  void look_at_rows(const std::string& group, const std::string& name) {
    const std::string path = path_in(group, name);
    const Handle dataset(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
    if (!dataset.valid()) return;
    std::string lower = name;
    std::transform(lower.begin(), lower.end(), lower.begin(), [](char c) { return static_cast<char>(c | 0x20); });
    const FieldNames fields = fields_of_records(dataset.get());
    const Handle space(H5Dget_space(dataset.get()), H5Sclose);
    const Handle type(H5Dget_type(dataset.get()), H5Tclose);
    const bool is_matrix = H5Sget_simple_extent_ndims(space.get()) == 2 && H5Tget_class(type.get()) != H5T_COMPOUND &&
                           (lower.find("event") != std::string::npos || lower.find("evts") != std::string::npos);
    if (fields[0].empty() && !is_matrix) return;
    add({lower == "events" && !group.empty() ? group : path, {}, path, fields}, path == "events");
  }

  void add(EventPlace place, bool is_usual) {
    places.insert(is_usual ? places.begin() : places.end(), std::move(place));
  }

  hid_t file_;
  size_t num_left_ = kMostObjects;
};

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

std::vector<EventPlace> find_event_places(hid_t file) {
  Search search(file);
  search.look_into("", 0);
  return std::move(search.places);
}

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

}  // namespace e2lf::recordings::hdf5_events::dsec
