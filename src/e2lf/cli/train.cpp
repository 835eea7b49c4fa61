// SPDX-License-Identifier: MIT
// e2lf train, e2lf resume: joint training of patterns and network
#include "e2lf/cli/trainer_program.h"
#include "e2lf/cli/verb.h"

namespace e2lf::cli {
namespace {

std::vector<std::string> with_overrides(std::vector<std::string> arguments, const std::vector<std::string>& overrides) {
  for (const std::string& assignment : overrides) arguments.insert(arguments.end(), {"--set", assignment});
  return arguments;
}

}  // namespace

int run_train(const std::vector<std::string>& arguments) {
  Verb verb("train", "Learn aperture patterns and the network together; docs/training.md explains the configuration.",
            "e2lf train configs/first-run.json -o runs/first --set data.file=packed.safetensors");
  std::string config, run;
  verb.keep_overrides();
  verb.app().add_option("config", config, "configuration (.json)")->required()->check(CLI::ExistingFile);
  verb.app().add_option("-o,--output", run, "folder for logs, checkpoint and model")->required();
  return verb.run(arguments, [&] {
    return become_trainer(with_overrides({"train", config, "-o", run}, verb.overrides()), verb.common().threads);
  });
}

int run_resume(const std::vector<std::string>& arguments) {
  Verb verb("resume", "Continue a training run from its last checkpoint.",
            "e2lf resume runs/first --set train.steps=2000");
  std::string run;
  verb.keep_overrides();
  verb.app().add_option("run", run, "folder of the run")->required()->check(CLI::ExistingDirectory);
  return verb.run(arguments, [&] {
    return become_trainer(with_overrides({"resume", run}, verb.overrides()), verb.common().threads);
  });
}

}  // namespace e2lf::cli
