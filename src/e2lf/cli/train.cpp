// SPDX-License-Identifier: MIT
// e2lf train, e2lf resume: joint training of patterns and network
#include <cerrno>
#include <cstring>
#include <unistd.h>

#include "e2lf/base/text.h"
#include "e2lf/cli/verb.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

/// Becomes e2lf-train, the program beside this one that holds training: torch is loaded for it alone. Returns only when
/// it is not there.
Result<void> become_trainer(std::vector<std::string> arguments, const std::vector<std::string>& overrides) {
  for (const std::string& assignment : overrides) arguments.insert(arguments.end(), {"--set", assignment});
  std::error_code status;
  const std::string program = (fs::read_symlink("/proc/self/exe", status).parent_path() / "e2lf-train").string();
  std::vector<char*> pointers = {const_cast<char*>(program.c_str())};
  for (std::string& argument : arguments) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  ::execv(program.c_str(), pointers.data());
  return Error{ErrorCode::kMissingDependency,
               cat("cannot start it (", std::strerror(errno), "); install libtorch-dev, configure again and rebuild"),
               program};
}

}  // namespace

int run_train(const std::vector<std::string>& arguments) {
  Verb verb("train", "Learn aperture patterns and the network together; docs/training.md explains the configuration.",
            "e2lf train configs/first-run.json -o runs/first --set data.file=packed.safetensors");
  std::string config, run;
  verb.keep_overrides();
  verb.app().add_option("config", config, "configuration (.json)")->required()->check(CLI::ExistingFile);
  verb.app().add_option("-o,--output", run, "folder for logs, checkpoint and model")->required();
  return verb.run(arguments, [&] { return become_trainer({"train", config, "-o", run}, verb.overrides()); });
}

int run_resume(const std::vector<std::string>& arguments) {
  Verb verb("resume", "Continue a training run from its last checkpoint.",
            "e2lf resume runs/first --set train.steps=2000");
  std::string run;
  verb.keep_overrides();
  verb.app().add_option("run", run, "folder of the run")->required()->check(CLI::ExistingDirectory);
  return verb.run(arguments, [&] { return become_trainer({"resume", run}, verb.overrides()); });
}

}  // namespace e2lf::cli
