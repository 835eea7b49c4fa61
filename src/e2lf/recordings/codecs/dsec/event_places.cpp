// SPDX-License-Identifier: MIT
#include "e2lf/recordings/codecs/dsec/event_places.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/recordings/table/column_names.h"

namespace e2lf::recordings::hdf5_events {
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

/// Collects the names of the fields; of two names for one field, the better one is used.
class FieldNames {
 public:
  void add(const std::string& name, const std::string& path) {
    const table::ColumnName known = table::parse_column_name(name);
    if (!known.field) return;
    auto& [rank, chosen] = best_[static_cast<size_t>(*known.field)];
    if (!chosen.empty() && rank <= known.rank) return;
    rank = known.rank;
    chosen = path;
  }
  [[nodiscard]] const std::string& of(table::Field field) const { return best_[static_cast<size_t>(field)].second; }
  [[nodiscard]] std::array<std::string, 4> all() const {
    return {best_[0].second, best_[1].second, best_[2].second, best_[3].second};
  }
  [[nodiscard]] bool are_complete() const {
    return std::none_of(best_.begin(), best_.end(), [](const auto& field) { return field.second.empty(); });
  }

 private:
  std::array<std::pair<size_t, std::string>, table::kNumFields> best_;
};

/// Returns the names of the fields x, y, p and t of a data set of records; all are empty unless it has all of them.
std::array<std::string, 4> fields_of_records(hid_t dataset) {
  const Handle type(H5Dget_type(dataset), H5Tclose);
  FieldNames names;
  if (!type.valid() || H5Tget_class(type.get()) != H5T_COMPOUND) return {};
  for (unsigned i = 0; i < static_cast<unsigned>(std::max(0, H5Tget_nmembers(type.get()))); ++i) {
    char* const name = H5Tget_member_name(type.get(), i);
    if (name != nullptr) names.add(name, name);
    H5free_memory(name);
  }
  return names.are_complete() ? names.all() : std::array<std::string, 4>();
}

class Search {
 public:
  explicit Search(hid_t file) : file_(file) {}

  void look_into(const std::string& group, int depth) {
    const std::vector<Object> members = members_of(file_, group, num_left_);
    FieldNames names;
    for (const Object& member : members) {
      if (!member.is_group) names.add(member.name, path_in(group, member.name));
    }
    const bool is_usual = group == "events" || group.empty();
    const bool has_some = !names.of(table::Field::kT).empty() &&
                          !(names.of(table::Field::kX).empty() && names.of(table::Field::kY).empty());
    if (names.are_complete() || (is_usual && has_some)) {
      add({group.empty() ? "/" : group, with_usual_names(names.all(), group), "", {}}, is_usual);
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
  static std::array<std::string, 4> with_usual_names(std::array<std::string, 4> names, const std::string& group) {
    for (size_t field = 0; field < names.size(); ++field) {
      if (names[field].empty()) names[field] = path_in(group, std::string(1, table::kFieldLetters[field]));
    }
    return names;
  }

  void look_at_rows(const std::string& group, const std::string& name) {
    const std::string path = path_in(group, name);
    const Handle dataset(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), H5Dclose);
    if (!dataset.valid()) return;
    std::string lower = name;
    std::transform(lower.begin(), lower.end(), lower.begin(), [](char c) { return static_cast<char>(c | 0x20); });
    const std::array<std::string, 4> fields = fields_of_records(dataset.get());
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

}  // namespace

std::vector<EventPlace> find_event_places(hid_t file) {
  Search search(file);
  search.look_into("", 0);
  return std::move(search.places);
}

}  // namespace e2lf::recordings::hdf5_events
