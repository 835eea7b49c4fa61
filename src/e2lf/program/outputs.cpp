// SPDX-License-Identifier: MIT
#include "e2lf/program/outputs.h"

#include <algorithm>
#include <cmath>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/base/threads.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/file.h"
#include "e2lf/files/sha256.h"
#include "e2lf/info/version.h"
#include "e2lf/program/options.h"
#include "e2lf/program/sibling_program.h"
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

RunRecord::RunRecord(const Verb& verb, const std::vector<fs::path>& inputs) : verb_(&verb) {
  for (const fs::path& input : inputs) add_input(input);
}

void RunRecord::add_input(const fs::path& path) {
  if (is_file(path) || is_folder(path)) inputs_.push_back({path, ""});
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

Json RunRecord::json_so_far() const {
  Json record;
  record["written_by"] = "e2lf";
  record["verb"] = verb_->name();
  record["version"] = info::kVersion;
  std::error_code ignored;
  record["folder"] = fs::current_path(ignored).string();
  record["options"] = verb_->resolved_options();
  record["options"].update(determined_);
  record["determined"] = Json::array();
  for (const auto& [option, value] : determined_.items()) record["determined"].push_back(option);
  record["seed"] = verb_->common().seed;
  record["threads"] = num_threads();
  record["complete"] = false;
  return record;
}

Result<Json> RunRecord::json() const {
  Json record = json_so_far();
  record.erase("complete");
  record["inputs"] = Json::array();
  for (const Input& input : inputs_) {
    std::string hash = input.sha256;
    if (hash.empty()) {
      ProgressBar bar("hash " + input.path.filename().string(), verb_->common().quiet);
      E2LF_ASSIGN_OR_RETURN(hash, sha256_of(input.path, bar.callback()));
    }
    record["inputs"].push_back({{"path", input.path.string()}, {"sha256", hash}});
  }
  warn_of_other_inputs(record["inputs"], verb_->earlier_run());
  record["timings_s"] = timings_s_;
  if (!notes_.empty()) record["notes"] = notes_;
  return record;
}

Result<void> RunRecord::write(const fs::path& path) const {
  E2LF_ASSIGN_OR_RETURN(const Json record, json());
  return write_file(path, json_text(record));
}

OutputRules recording_output_rules(const Verb& verb, const recordings::Codec& codec) {
  return recordings::recording_output_rules(verb.named_inputs(), verb.common().overwrite, codec);
}

OutputRules output_rules(const Verb& verb, const std::vector<fs::path>& more) {
  std::vector<fs::path> inputs = verb.named_inputs();
  inputs.insert(inputs.end(), more.begin(), more.end());
  return recordings::output_rules(inputs, verb.common().overwrite);
}

Result<OutputFile> open_output(const fs::path& named, const Verb& verb, std::string ending,
                               const std::vector<fs::path>& more) {
  OutputRules rules = output_rules(verb, more);
  rules.ending = std::move(ending);
  return OutputFile::create(named, rules);
}

Result<ResultFolder> open_output_folder(const fs::path& named, const Verb& verb, const std::vector<fs::path>& more) {
  return open_result_folder(named, output_rules(verb, more));
}

Result<void> commit(OutputFile& output, const RunRecord& record) {
  if (!output.is_stream()) E2LF_RETURN_IF_ERROR(record.write(output.record_path()));
  return output.commit();
}

Result<void> commit(ResultFolder& folder, const RunRecord& record) {
  E2LF_ASSIGN_OR_RETURN(Json about, record.json());
  return folder.commit(std::move(about));
}

namespace {

/// Returns the path or address of a run that was started in `folder` for a run in the current folder.
std::string from_folder(const fs::path& folder, const std::string& recorded) {
  constexpr std::string_view kReplay = "replay:";  // a file name follows
  if (recorded.starts_with(kReplay)) return cat(kReplay, from_folder(folder, recorded.substr(kReplay.size())));
  const bool is_file_name = !recorded.empty() && recorded != "-" && recorded.find("://") == std::string::npos;
  return is_file_name ? (folder / recorded).lexically_normal().string() : recorded;  // an absolute path stays
}

/// Returns whether the value of an option is a path: always for paths, and unless it names a bundled file for options
/// that also accept such names. A path stays one when its file is gone, so that no other of this name is taken.
bool holds_path(const CLI::Option* option, const std::string& value, const fs::path& folder) {
  if (option == nullptr) return false;
  const std::string type = value_type(*option);
  if (type == kThingType) return is_present(folder / value);
  const bool is_camera = type == kCameraType;
  if (!is_camera && type != kModelType && type != kCodesType) return type == kPathType;
  return is_file(folder / value) || !bundled_file_named(is_camera ? kBundledCameras : kBundledModels, value);
}

}  // namespace

void resolve_recorded_paths(Json& record, const CLI::App& app) {
  // Records of older versions do not contain the folder in which their run was started.
  const fs::path folder = record.value("folder", "");
  for (Json& input : record.contains("inputs") ? record["inputs"] : record["inputs"] = Json::array()) {
    if (!input.is_object() || !input.contains("path") || !input["path"].is_string()) continue;
    input["path"] = from_folder(folder, input["path"]);
  }
  for (auto& [name, values] : record["options"].items()) {
    const CLI::Option* const option = app.get_option_no_throw("--" + name);
    const auto resolve = [&](Json& value) {
      if (value.is_string() && holds_path(option, value, folder)) value = from_folder(folder, value);
    };
    if (!values.is_array()) resolve(values);
    if (values.is_array()) std::ranges::for_each(values, resolve);
  }
}

void add_report_option(CLI::App& app, std::vector<fs::path>& names) {
  const auto check = [](std::string& text) {
    const auto known = report::check_extension(text);
    return known ? std::string() : known.error().text();
  };
  app.add_option(
         "--report", names,
         "also write a report of the run: a page (.html), its tables (.tex; .csv for the first one) or its first "
         "chart (.svg); may be given several times")
      ->check(CLI::Validator(check, ""))
      ->allow_extra_args(false);
}

Result<ReportOutput> ReportOutput::open(const std::vector<fs::path>& names, const OutputRules& rules) {
  ReportOutput made;
  for (const fs::path& name : names) {
    E2LF_ASSIGN_OR_RETURN(OutputFile output, OutputFile::create(name, rules));
    made.files_.push_back({name, std::move(output)});
  }
  return made;
}

Result<void> ReportOutput::write(const report::Page& page) {
  for (File& file : files_) {
    E2LF_ASSIGN_OR_RETURN(const std::string text, report::file_text(page, file.name));
    E2LF_RETURN_IF_ERROR(write_file(file.output.path(), text));
    E2LF_RETURN_IF_ERROR(file.output.commit());
  }
  return {};
}

report::Page verb_page(const std::string& title) {
  // The command line as it was typed, as far as possible.
  std::string command = "e2lf";
  for (const std::string& word : own_arguments()) command += " " + shell_word(word);
  report::Page page(title);
  page.code(command);
  return page;
}

}  // namespace e2lf::program
