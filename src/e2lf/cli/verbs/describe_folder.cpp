// SPDX-License-Identifier: MIT
#include <algorithm>
#include <fstream>

#include "e2lf/base/text.h"
#include "e2lf/cli/verbs/describe.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

/// Returns the names in a folder, sorted.
std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    names.push_back(entry->path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Returns the number at the start of the last line; 0 if there is none.
uint64_t last_step(const fs::path& log) {
  std::ifstream in(log);
  uint64_t step = 0;
  for (std::string line; std::getline(in, line);) step = std::strtoull(line.c_str(), nullptr, 10);
  return step;
}

Result<Description> describe_training_run(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const Json config, read_json(path / "config.json"));
  const Json::json_pointer name_at("/name"), steps_at("/train/steps");
  const bool has_name = config.contains(name_at) && config[name_at].is_string();
  const bool has_steps = config.contains(steps_at) && config[steps_at].is_number_unsigned();
  const std::string name = has_name ? config[name_at].get<std::string>() : "model";
  const uint64_t steps = has_steps ? config[steps_at].get<uint64_t>() : 0, done = last_step(path / "log.csv");
  const fs::path model = path / (name + ".safetensors");
  std::error_code error;
  const bool has_model = fs::exists(model, error);
  std::string text = cat("training run of ", name, ": ", done, " of ", steps, " steps are logged; `e2lf resume ",
                         path.string(), "` continues it\n");
  text += has_model ? cat("its model: `e2lf info ", model.string(), "`\n") : "it has no model yet\n";
  if (fs::exists(path / "curves.html", error)) text += cat("its curves: ", (path / "curves.html").string(), "\n");
  return Description{std::move(text),
                     {{"kind", "training run"},
                      {"name", name},
                      {"steps", steps},
                      {"logged_steps", done},
                      {"model", has_model ? Json(model.string()) : Json()}},
                     {}};
}

Result<Description> describe_display(const fs::path& path) {
  const std::vector<std::string> names = names_in(path);
  const auto frames =
      std::count_if(names.begin(), names.end(), [](const std::string& name) { return name.starts_with("frame_"); });
  return Description{
      cat("images for an aperture display: ", frames, " frames in the order of their numbers, see ",
          "contact_sheet.png\nschedule.csv is for the program that shows them, schedule.json for --schedule, and ",
          "codes.json for --codes\n"),
      {{"kind", "display"}, {"frames", frames}},
      {}};
}

Result<Description> describe_results(const fs::path& path) {
  E2LF_ASSIGN_OR_RETURN(const Json record, read_json(path / "run.json"));
  const std::string verb = record.value("verb", "");
  std::vector<std::string> names = names_in(path);
  std::erase(names, "run.json");
  return Description{cat("results of `e2lf ", verb, "`: ", join(names),
                         "\nrun.json describes the run that made them; give one of them for more information\n"),
                     {{"kind", "results"}, {"verb", verb}, {"names", names}},
                     {}};
}

}  // namespace

Result<Description> describe_folder(FileKind kind, const fs::path& path) {
  if (kind == FileKind::kTrainingRun) return describe_training_run(path);
  return kind == FileKind::kDisplay ? describe_display(path) : describe_results(path);
}

}  // namespace e2lf::cli
