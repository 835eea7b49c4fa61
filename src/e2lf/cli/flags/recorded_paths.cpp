// SPDX-License-Identifier: MIT
// find_recorded_paths() of verb.h
#include <algorithm>
#include <filesystem>

#include "e2lf/base/text.h"
#include "e2lf/cli/flags/option_values.h"
#include "e2lf/cli/verb.h"
#include "e2lf/recordings/live/cameras.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

/// The prefix of a recording that is replayed at its own speed; a file name follows.
constexpr std::string_view kReplay = "replay:";

struct Place {
  std::string path;
  bool is_found = true;
};

/// Returns the current location of a path of a run that was started in `folder`.
Place place_of(const std::string& recorded, const fs::path& folder) {
  if (recorded.starts_with(kReplay)) {
    const std::string address = recorded.substr(kReplay.size());
    const size_t size = fs::exists(folder / address) ? address.size() : recordings::replay_path_size(address);
    Place place = place_of(address.substr(0, size), folder);
    place.path = cat(kReplay, place.path, address.substr(size));
    return place;
  }
  std::error_code error;
  const bool is_file_name = !recorded.empty() && recorded != "-" && recorded.find("://") == std::string::npos;
  if (!is_file_name) return {recorded};
  const fs::path there = folder / recorded;  // an absolute path stays
  if (fs::exists(there, error)) return {there.lexically_normal().string()};
  if (fs::exists(recorded, error)) return {fs::absolute(recorded, error).lexically_normal().string()};
  return {there.lexically_normal().string(), false};
}

/// Returns whether the value of an option is a path: always for paths, and only if a file has this name for options
/// that also accept bundled names.
bool holds_path(const CLI::Option* option, const std::string& value, const fs::path& folder) {
  if (option == nullptr) return false;
  const std::string type = option->get_type_name();
  std::error_code error;
  const bool may_be_name = type == kModelType || type == kCodesType || type == kCameraType;
  if (type == kThingType) return fs::exists(folder / value, error);
  return type == kPathType || (may_be_name && fs::is_regular_file(folder / value, error));
}

Error missing(const std::string& recorded, const std::string& flag, const fs::path& folder) {
  std::error_code error;
  const bool is_absolute = fs::path(recorded).is_absolute();
  const std::string tried = is_absolute
                                ? "the file or folder no longer exists"
                                : cat("it is neither in ", folder.string(), ", where the run was started, nor in ",
                                      fs::current_path(error).string(), ", the current folder");
  return {ErrorCode::kNotFound, cat("an input of the earlier run is missing: ", tried, "; give it with ", flag),
          recorded};
}

}  // namespace

std::vector<MissingInput> find_recorded_paths(Json& record, const CLI::App& app) {
  std::error_code error;
  // Records of older versions do not contain the folder in which their run was started.
  const fs::path start = record.value("folder", fs::current_path(error).string());
  const fs::path folder = fs::is_directory(start, error) ? start : fs::current_path(error);
  std::vector<std::string> inputs;
  for (Json& input : record.contains("inputs") ? record["inputs"] : record["inputs"] = Json::array()) {
    if (!input.is_object() || !input.contains("path") || !input["path"].is_string()) continue;
    inputs.push_back(input["path"]);
    input["path"] = place_of(inputs.back(), folder).path;
  }
  std::vector<MissingInput> missing_inputs;
  for (auto& [name, values] : record["options"].items()) {
    const std::string flag = "--" + name;
    const CLI::Option* const option = app.get_option_no_throw(flag);
    const auto find = [&](Json& value) {
      if (!value.is_string()) return;
      const std::string recorded = value;
      const bool is_input = std::find(inputs.begin(), inputs.end(), recorded) != inputs.end();
      if (!is_input && !holds_path(option, recorded, folder)) return;
      const Place place = place_of(recorded, folder);
      if (is_input && !place.is_found) missing_inputs.push_back({flag, place.path, missing(recorded, flag, start)});
      value = place.path;
    };
    if (!values.is_array()) find(values);
    if (values.is_array()) std::for_each(values.begin(), values.end(), find);
  }
  return missing_inputs;
}

}  // namespace e2lf::cli
