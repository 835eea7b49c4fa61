// SPDX-License-Identifier: MIT
#include "e2lf/program/run_record.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <span>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/files/sha256.h"
#include "e2lf/info/version.h"
#include "e2lf/program/option_values.h"
#include "e2lf/program/verb.h"
#include "e2lf/recordings/live/camera.h"
#include "e2lf/recordings/open/open_named_recording.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::program {
namespace fs = std::filesystem;
namespace {

/// Warns of inputs that have changed since the run that is repeated.
void warn_of_other_inputs(const Json& inputs, const Json& earlier_run) {
  if (!earlier_run.is_object() || !earlier_run.contains("inputs")) return;
  const auto whole = [](const Json& input) { return fs::absolute(input.value("path", "")).lexically_normal(); };
  for (const Json& earlier : earlier_run["inputs"]) {
    for (const Json& input : inputs) {
      if (!earlier.is_object() || whole(earlier) != whole(input)) continue;
      if (earlier.value("sha256", "") == input["sha256"]) continue;
      log_warning(
          cat(input["path"].get<std::string>(), " has changed since the earlier run, so the result will differ"));
    }
  }
}

}  // namespace

RunRecord::RunRecord(std::string verb, const std::vector<fs::path>& inputs) : verb_(std::move(verb)) {
  for (const fs::path& input : inputs) add_input(input);
}

void RunRecord::add_input(const fs::path& path) {
  std::error_code error;
  if (fs::is_regular_file(path, error) || fs::is_directory(path, error)) inputs_.push_back({path, ""});
}

void RunRecord::add_input(const fs::path& path, std::span<const uint8_t> bytes) {
  inputs_.push_back({path, sha256_of_bytes(bytes)});
}

void RunRecord::end_step(const std::string& name) {
  const Clock::time_point now = Clock::now();
  const double seconds = std::chrono::duration<double>(now - step_begin_).count();
  timings_s_[name] = std::round(seconds * 1e4) / 1e4;
  step_begin_ = now;
}

Json RunRecord::json_so_far(const Verb& verb) const {
  Json record;
  record["written_by"] = "e2lf";
  record["verb"] = verb_;
  record["version"] = info::kVersion;
  std::error_code ignored;
  record["folder"] = fs::current_path(ignored).string();
  record["options"] = verb.resolved_options();
  record["options"].update(resolved_);
  record["seed"] = verb.common().seed;
  record["threads"] = num_threads();
  record["complete"] = false;
  return record;
}

Result<Json> RunRecord::json(const Verb& verb) const {
  Json record = json_so_far(verb);
  record.erase("complete");
  record["inputs"] = Json::array();
  for (const Input& input : inputs_) {
    std::string hash = input.sha256;
    if (hash.empty()) {
      ProgressBar bar("hash " + input.path.filename().string(), verb.common().quiet);
      E2LF_ASSIGN_OR_RETURN(hash, sha256_of(input.path, bar.callback()));
    }
    record["inputs"].push_back({{"path", input.path.string()}, {"sha256", hash}});
  }
  warn_of_other_inputs(record["inputs"], verb.earlier_run());
  record["timings_s"] = timings_s_;
  if (!notes_.empty()) record["notes"] = notes_;
  return record;
}

Result<void> RunRecord::write(const fs::path& path, const Verb& verb) const {
  E2LF_ASSIGN_OR_RETURN(const Json record, json(verb));
  return write_file(path, json_text(record));
}

OutputRules output_rules(const Verb& verb, const std::vector<fs::path>& inputs, std::string ending) {
  OutputRules rules = recordings::output_rules(inputs, verb.common().overwrite);
  rules.ending = std::move(ending);
  return rules;
}

Result<OutputFile> open_output(const fs::path& named, const Verb& verb, const std::vector<fs::path>& inputs,
                               std::string ending) {
  return OutputFile::create(named, output_rules(verb, inputs, std::move(ending)));
}

Result<ResultFolder> open_output_folder(const fs::path& named, const Verb& verb, const std::vector<fs::path>& inputs) {
  return open_result_folder(named, output_rules(verb, inputs));
}

Result<void> commit(OutputFile& output, const RunRecord& record, const Verb& verb) {
  if (!output.is_stream()) E2LF_RETURN_IF_ERROR(record.write(output.record_path(), verb));
  return output.commit();
}

Result<void> commit(ResultFolder& folder, const RunRecord& record, const Verb& verb) {
  E2LF_ASSIGN_OR_RETURN(Json about, record.json(verb));
  return folder.commit(std::move(about));
}

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

}  // namespace e2lf::program
