// SPDX-License-Identifier: MIT
// e2lf compare: compares methods over scenes, sensors and seeds, and writes tables and a page
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "e2lf/base/log.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/flags/event_flags.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/compare/jobs.h"
#include "e2lf/compare/tables.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/files/sha256.h"
#include "e2lf/info/version.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/outputs.h"
#include "e2lf/program/sibling_program.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace {

namespace fs = std::filesystem;

struct CompareArguments {
  fs::path config, output, data;
  std::vector<fs::path> merged;
  std::string shard, device = "cpu";
  bool again = false, json = false;
};

Result<compare::Shard> parse_shard(const std::string& text) {
  if (text.empty()) return compare::Shard();
  const size_t slash = text.find('/');
  const auto number = parse_number<size_t>(text.substr(0, slash));
  const auto count = parse_number<size_t>(slash == std::string::npos ? "" : text.substr(slash + 1));
  if (number && count && *number >= 1 && *number <= *count) return compare::Shard{*number, *count};
  return fail(ErrorCode::kInvalidValue, "--shard " + text,
              "a shard is a number and a total, counted from 1; give e.g. 1/4");
}

/// Finds a file that a configuration names: beside the configuration, in the folder of data, or among the bundled
/// files.
Result<fs::path> locate(const CompareArguments& arguments, const std::string& name) {
  const fs::path path = name;
  const fs::path beside = arguments.config.parent_path() / path;
  if (is_present(beside)) return beside.lexically_normal();
  if (!arguments.data.empty() && is_present(arguments.data / path)) return arguments.data / path;
  if (const auto bundled = bundled_file(name); bundled && path.is_relative()) return *bundled;
  if (const auto model = bundled_file_named(kBundledModels, name)) return *model;
  const std::string data =
      arguments.data.empty() ? "no folder of data is given (--data or E2LF_DATA)" : "in " + arguments.data.string();
  return fail(ErrorCode::kNotFound, name,
              "there is no such file or folder beside the configuration, among the bundled files, and ", data,
              "; correct the name");
}

compare::Environment environment_of(const CompareArguments& arguments) {
  compare::Environment environment;
  environment.locate = [&](const std::string& name) { return locate(arguments, name); };
  environment.locate_camera = [&](const std::string& name) -> Result<fs::path> {
    const auto camera = locate(arguments, name);
    return camera && is_file(*camera) ? camera : find_camera(name);
  };
  environment.hash = [](const fs::path& path) { return sha256_of(path); };
  environment.version = kVersion;
  environment.device = arguments.device;
  return environment;
}

Result<compare::ComparisonConfig> configuration(const CompareArguments& arguments, const Verb& verb) {
  E2LF_ASSIGN_OR_RETURN(Json json, read_json(arguments.config));
  for (const std::string& assignment : verb.overrides()) E2LF_RETURN_IF_ERROR(apply_override(json, assignment));
  return compare::config_from_json(json, arguments.config.string());
}

Result<void> take_over(const CompareArguments& arguments, const compare::Plan& plan,
                       const compare::ResultStore& store) {
  for (const fs::path& folder : arguments.merged) {
    std::error_code ignored;
    if (!is_our_record(folder / "run.json") || !fs::is_directory(folder / "results", ignored)) {
      return fail(ErrorCode::kNotFound, folder,
                  "the folder contains no results of `e2lf compare`; give the output folder of a comparison");
    }
    E2LF_ASSIGN_OR_RETURN(const size_t taken, store.take_over(plan, compare::ResultStore(folder)));
    log_info(cat(folder.string(), ": ", taken, taken == 1 ? " result" : " results", " copied"));
  }
  return {};
}

/// Prints the results that exist, and warns about sums that saturated and about results that are missing.
void tell(const CompareArguments& arguments, const compare::Plan& plan, const compare::Results& results,
          size_t new_results, const Verb& verb) {
  const auto there =
      static_cast<size_t>(std::ranges::count_if(results, [](const auto& result) { return result.has_value(); }));
  if (arguments.json) {
    Json json = compare::all_json(plan, results);
    json["new_results"] = new_results;
    json["missing_results"] = results.size() - there;
    std::printf("%s", json_text(json).c_str());
  } else if (!verb.common().quiet) {
    for (size_t sensor = 0; sensor < plan.sensors.size(); ++sensor) {
      for (const report::Table& table :
           {compare::quality_table(plan, results, sensor), compare::cost_table(plan, results, sensor)}) {
        if (table.columns.size() < 2) continue;
        std::printf("%s\n%s\n", table.caption.c_str(), report::table_text(table).c_str());
      }
    }
    std::printf("%zu new results, %zu of %zu done. In %s: index.html, table.csv, table.json, table.tex, results/\n",
                new_results, there, results.size(), arguments.output.c_str());
  }
  uint64_t lost_events = 0;
  for (const auto& result : results) lost_events += result ? result->value("saturated_events", uint64_t{0}) : 0;
  if (lost_events > 0) {
    log_warning(cat("sums over several cycles saturated and lost ", lost_events, " events; use fewer cycles"));
  }
  if (there < results.size() && (arguments.shard.empty() || stop_requested())) {
    log_warning(
        cat(results.size() - there, " of ", results.size(), " results are missing; repeat the command to continue"));
  }
}

Result<void> compare_methods(CompareArguments arguments, const Verb& verb) {
  const char* const data = std::getenv("E2LF_DATA");
  if (arguments.data.empty() && data != nullptr) arguments.data = data;
  E2LF_RETURN_IF_ERROR(require_device(arguments.device));
  E2LF_ASSIGN_OR_RETURN(const compare::Shard shard, parse_shard(arguments.shard));
  E2LF_ASSIGN_OR_RETURN(const compare::ComparisonConfig config, configuration(arguments, verb));
  RunRecord record(verb);
  E2LF_ASSIGN_OR_RETURN(const compare::Plan plan, compare::make_plan(config, environment_of(arguments)));
  GrowingFolder folder{"compare", {std::begin(compare::kTableFiles), std::end(compare::kTableFiles)}};
  E2LF_RETURN_IF_ERROR(folder.open(arguments.output, output_rules(verb, plan.files), record.json_so_far()));
  record.end_step("plan");
  const compare::ResultStore store(folder.path());
  E2LF_RETURN_IF_ERROR(take_over(arguments, plan, store));
  const std::vector<size_t> jobs = compare::open_jobs(plan, store, shard, arguments.again);
  ProgressBar bar("compare", verb.common().quiet);
  E2LF_ASSIGN_OR_RETURN(const size_t new_results, compare::run_jobs(plan, jobs, store, bar.callback()));
  hide_progress();
  record.end_step("measure");
  compare::Results results;
  for (const compare::Job& job : plan.jobs) results.push_back(store.find(job));
  const std::string command = cat("e2lf compare ", arguments.config.string(), " -o ", arguments.output.string());
  E2LF_RETURN_IF_ERROR(compare::write_tables(folder.path(), plan, results, store, command));
  record.end_step("write");
  record.add_input(arguments.config);
  for (const fs::path& file : plan.files) record.add_input(file);
  record.note("new_results", new_results);
  record.note("results", results.size());
  E2LF_ASSIGN_OR_RETURN(Json about, record.json());
  E2LF_RETURN_IF_ERROR(folder.write_record(std::move(about)));
  tell(arguments, plan, results, new_results, verb);
  return {};
}

}  // namespace

int run_compare(const std::vector<std::string>& arguments) {
  Verb verb(
      "compare",
      "Compare methods over scenes, sensors and seeds, and write tables and a page. Existing results are not computed "
      "again. docs/compare.md describes the configuration, whose keys --set changes (--set seeds=[1,2]).",
      "e2lf compare configs/compare.json -o out/compare");
  CompareArguments compare_arguments;
  verb.keep_overrides();
  CLI::App& app = verb.app();
  app.add_option("config", compare_arguments.config, "configuration (.json)")->required()->check(CLI::ExistingFile);
  app.add_option("-o,--output", compare_arguments.output, "folder for the results, new or of an earlier run")
      ->required();
  app.add_option("--data", compare_arguments.data, "folder of scenes and models; default: E2LF_DATA");
  app.add_option("--shard", compare_arguments.shard, "compute a part of the results: 1/4 is the first of four parts");
  app.add_option("--merge", compare_arguments.merged, "copy the results of these folders")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_device_option(app, compare_arguments.device);
  app.add_flag("--again", compare_arguments.again, "compute existing results again");
  app.add_flag("--json", compare_arguments.json, "print the result as JSON");
  verb.stop_gently();
  return verb.run(arguments, [&] { return compare_methods(compare_arguments, verb); });
}

}  // namespace e2lf::cli
