// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/commands.h"

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/files/options.h"
#include "e2lf/files/output.h"
#include "e2lf/learn/run/run_log.h"
#include "e2lf/learn/run/torch_setup.h"
#include "e2lf/learn/run/trainer.h"

namespace e2lf::learn {
namespace {

constexpr const char* kCheckpoint = "checkpoint.safetensors";

/// Training frees and allocates the same large blocks in every step. Returning them to the system each time costs a
/// sixth of the time on a CPU.
void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  mallopt(M_TOP_PAD, 64 << 20);
#endif
}

Result<Config> read_config(const std::filesystem::path& path, const std::vector<std::string>& overrides,
                           const Peers& peers = {}) {
  // Only the first process reads the file; the others need not have it.
  Json json;
  if (peers.leads()) {
    E2LF_ASSIGN_OR_RETURN(json, read_json(path));
  }
  E2LF_ASSIGN_OR_RETURN(const auto text, peers.text_from_first(json_line(json)));
  json = Json::parse(text);
  for (const std::string& assignment : overrides) E2LF_RETURN_IF_ERROR(apply_override(json, assignment));
  return config_from_json(json, path.string() + ": $");
}

/// Returns whether a folder contains the same run, killed before its first checkpoint, so that nothing is lost by
/// starting again.
bool holds_a_false_start(const std::filesystem::path& folder, const Config& config) {
  const auto written = read_json(folder / "config.json");
  return written && *written == to_json(config) && !is_present(folder / kCheckpoint) &&
         !is_present(folder / (config.name + ".safetensors"));
}

/// Checks that a new run overwrites neither another run nor a file that happens to have one of its names.
Result<void> check_is_free(const std::filesystem::path& folder, const Config& config) {
  if (holds_a_false_start(folder, config)) return {};
  if (!check_output(folder / "config.json", /*overwrite=*/false)) {
    return fail(ErrorCode::kExists, folder,
                "this folder already contains a run; continue it with `e2lf resume`, or choose another folder");
  }
  std::vector<std::string> names = RunLog::file_names();
  names.insert(names.end(), {kCheckpoint, config.name + ".safetensors"});
  for (const std::string& name : names) {
    if (check_output(folder / name, /*overwrite=*/false)) continue;
    return fail(ErrorCode::kExists, (folder / name),
                "training would overwrite this file; move it away or choose another folder");
  }
  return {};
}

Result<Trainer> open_run(const std::filesystem::path& run, const std::vector<std::string>& overrides) {
  E2LF_ASSIGN_OR_RETURN(const auto config, read_config(run / "config.json", overrides));
  E2LF_ASSIGN_OR_RETURN(auto trainer, Trainer::create(config));
  E2LF_RETURN_IF_ERROR(trainer.load_checkpoint(run / kCheckpoint));
  return trainer;
}

/// Trains to the end and writes the model. A new run must not overwrite anything; another one continues at its
/// checkpoint.
Result<std::filesystem::path> run_and_export(const std::filesystem::path& config_path, const std::filesystem::path& run,
                                             bool is_new, const std::vector<std::string>& overrides,
                                             const ProgressFn& progress, const std::function<bool()>& keep_going) {
  E2LF_ASSIGN_OR_RETURN(auto peers, Peers::meet());
  E2LF_ASSIGN_OR_RETURN(const auto config, read_config(config_path, overrides, peers));
  if (is_new && peers.leads()) E2LF_RETURN_IF_ERROR(check_is_free(run, config));
  E2LF_ASSIGN_OR_RETURN(const auto device, open_device(config.device));
  E2LF_RETURN_IF_ERROR(peers.connect(device));
  E2LF_ASSIGN_OR_RETURN(auto trainer, Trainer::create(config, peers));
  // The other processes receive the state of the first. A run that was killed before its first checkpoint starts
  // again.
  if (!is_new && peers.leads() && is_present(run / kCheckpoint)) {
    E2LF_RETURN_IF_ERROR(trainer.load_checkpoint(run / kCheckpoint));
  }
  keep_freed_memory();
  if (peers.leads()) remove_dead_parts(run);
  E2LF_RETURN_IF_ERROR(trainer.run(run, progress, keep_going));
  const auto model = run / (trainer.config().name + ".safetensors");
  if (peers.leads()) {
    E2LF_ASSIGN_OR_RETURN(const model::Model trained, trainer.to_model());
    E2LF_RETURN_IF_ERROR(model::write_model(model, trained));
  }
  return model;
}

/// Checks that an export does not replace a file that its run needs to continue.
Result<void> check_export(const std::filesystem::path& run, const std::filesystem::path& model) {
  std::vector<std::string> names = RunLog::file_names();
  names.insert(names.end(), {kCheckpoint, "config.json"});
  for (const std::string& name : names) {
    std::error_code error;
    if (!std::filesystem::equivalent(run / name, model, error)) continue;
    return fail(ErrorCode::kInvalidValue, model, "the model would replace a file of the run; choose another output");
  }
  return {};
}

}  // namespace

Result<std::filesystem::path> train(const std::filesystem::path& config_path, const std::filesystem::path& run,
                                    const std::vector<std::string>& overrides, const ProgressFn& progress,
                                    const std::function<bool()>& keep_going) {
  return guarded(config_path,
                 [&] { return run_and_export(config_path, run, /*is_new=*/true, overrides, progress, keep_going); });
}

Result<std::filesystem::path> resume(const std::filesystem::path& run, const std::vector<std::string>& overrides,
                                     const ProgressFn& progress, const std::function<bool()>& keep_going) {
  return guarded(
      run, [&] { return run_and_export(run / "config.json", run, /*is_new=*/false, overrides, progress, keep_going); });
}

Result<void> export_run(const std::filesystem::path& run, const std::filesystem::path& model, bool overwrite) {
  return guarded(run, [&]() -> Result<void> {
    E2LF_RETURN_IF_ERROR(check_export(run, model));
    E2LF_ASSIGN_OR_RETURN(auto output, OutputFile::create(model, {.overwrite = overwrite, .ending = ".safetensors"}));
    E2LF_ASSIGN_OR_RETURN(const auto trainer, open_run(run, {}));
    E2LF_ASSIGN_OR_RETURN(const model::Model trained, trainer.to_model());
    E2LF_RETURN_IF_ERROR(model::write_model(output.path(), trained));
    return output.commit();
  });
}

Result<std::string> evaluate_run(const std::filesystem::path& run, const std::vector<std::string>& scenes,
                                 const std::vector<std::string>& overrides) {
  return guarded(run, [&]() -> Result<std::string> {
    E2LF_ASSIGN_OR_RETURN(const auto trainer, open_run(run, overrides));
    const std::string column = trainer.figures().score_column;
    std::string table = cat("scene\t", column, "\tevents_per_pixel\t", column, "_without_noise\n");
    for (const capture::SensorProfile& camera : trainer.cameras()) {
      E2LF_ASSIGN_OR_RETURN(const auto usual, trainer.evaluate(scenes, camera));
      E2LF_ASSIGN_OR_RETURN(const auto clean, trainer.evaluate(scenes, capture::without_noise(camera)));
      for (size_t i = 0; i < usual.size(); ++i) {
        table += cat(usual[i].name, '\t', usual[i].score, '\t', usual[i].events_per_pixel, '\t', clean[i].score, '\n');
      }
    }
    return table;
  });
}

}  // namespace e2lf::learn
