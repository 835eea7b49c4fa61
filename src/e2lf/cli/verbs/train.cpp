// SPDX-License-Identifier: MIT
// e2lf train, e2lf resume: joint training of patterns and network
#include "e2lf/cli/output/report_output.h"
#include "e2lf/cli/verb.h"
#include "e2lf/cli/verbs/trainer_program.h"

namespace e2lf::cli {
namespace {

/// The arguments of the trainer's reports.
struct ReportArguments {
  std::vector<std::filesystem::path> names;
  bool overwrite = false;
};

void add_report_options(CLI::App& app, ReportArguments& reports) {
  add_report_option(app, reports.names);
  app.add_flag("--overwrite", reports.overwrite, "replace the files of --report");
}

/// Continues as the trainer, with the arguments that its verbs share.
Result<void> train_with(std::vector<std::string> arguments, const ReportArguments& reports, const Verb& verb) {
  for (const auto& name : reports.names) arguments.insert(arguments.end(), {"--report", name.string()});
  if (reports.overwrite) arguments.emplace_back("--overwrite");
  for (const std::string& assignment : verb.overrides()) arguments.insert(arguments.end(), {"--set", assignment});
  if (verb.common().quiet) arguments.emplace_back("--quiet");
  return become_trainer(std::move(arguments), verb.common().threads);
}

}  // namespace

int run_train(const std::vector<std::string>& arguments) {
  Verb verb("train",
            "Learn the aperture patterns and the network jointly. docs/training.md describes the configuration, whose "
            "keys --set changes (--set seed=7, --set device=cuda).",
            "e2lf train configs/first-run.json -o runs/first");
  std::string config, run;
  ReportArguments reports;
  verb.keep_overrides();
  verb.app().add_option("config", config, "configuration (.json)")->required()->check(CLI::ExistingFile);
  verb.app().add_option("-o,--output", run, "folder for logs, checkpoint and model")->required();
  add_report_options(verb.app(), reports);
  return verb.run(arguments, [&] { return train_with({"train", config, "-o", run}, reports, verb); });
}

int run_resume(const std::vector<std::string>& arguments) {
  Verb verb("resume", "Continue a training run from its last checkpoint.",
            "e2lf resume runs/first --set train.steps=2000");
  std::string run;
  ReportArguments reports;
  verb.keep_overrides();
  verb.app().add_option("run", run, "folder of the run")->required()->check(CLI::ExistingDirectory);
  add_report_options(verb.app(), reports);
  return verb.run(arguments, [&] { return train_with({"resume", run}, reports, verb); });
}

}  // namespace e2lf::cli
