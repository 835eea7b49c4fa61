// SPDX-License-Identifier: MIT
// e2lf train, e2lf resume: joint training of patterns and network
#include "e2lf/cli/trainer_program.h"
#include "e2lf/cli/verb.h"

namespace e2lf::cli {
namespace {

/// Goes on as the trainer, with what its verbs have in common.
Result<void> train_with(std::vector<std::string> arguments, const Verb& verb) {
  for (const std::string& assignment : verb.overrides()) arguments.insert(arguments.end(), {"--set", assignment});
  if (verb.common().quiet) arguments.emplace_back("--quiet");
  return become_trainer(std::move(arguments), verb.common().threads);
}

}  // namespace

int run_train(const std::vector<std::string>& arguments) {
  Verb verb("train",
            "Learn aperture patterns and the network together; docs/training-settings.md explains the configuration, "
            "whose keys "
            "--set changes (--set seed=7, --set device=cuda).",
            "e2lf train configs/first-run.json -o runs/first");
  std::string config, run;
  verb.keep_overrides();
  verb.app().add_option("config", config, "configuration (.json)")->required()->check(CLI::ExistingFile);
  verb.app().add_option("-o,--output", run, "folder for logs, checkpoint and model")->required();
  return verb.run(arguments, [&] { return train_with({"train", config, "-o", run}, verb); });
}

int run_resume(const std::vector<std::string>& arguments) {
  Verb verb("resume", "Continue a training run from its last checkpoint.",
            "e2lf resume runs/first --set train.steps=2000");
  std::string run;
  verb.keep_overrides();
  verb.app().add_option("run", run, "folder of the run")->required()->check(CLI::ExistingDirectory);
  return verb.run(arguments, [&] { return train_with({"resume", run}, verb); });
}

}  // namespace e2lf::cli
