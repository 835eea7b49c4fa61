// SPDX-License-Identifier: MIT
// The training verbs: pack, train and resume. The trainer itself is the program e2lf-train.
#include <cstdlib>
#include <filesystem>

#include "e2lf/base/text.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/learn/data/packed_data.h"
#include "e2lf/program/outputs.h"
#include "e2lf/program/sibling_program.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace {

/// Continues as e2lf-train, the program that contains training, so that only it loads torch. Adds the arguments that
/// its verbs share.
Result<void> train_with(std::vector<std::string> arguments, const Verb& verb) {
  for (const std::string& assignment : verb.overrides()) arguments.insert(arguments.end(), {"--set", assignment});
  if (verb.common().quiet) arguments.emplace_back("--quiet");
  // Read by torch and its BLAS; without it, the trainer uses all cores.
  const int threads = verb.common().threads;
  if (threads > 0) ::setenv("OMP_NUM_THREADS", std::to_string(threads).c_str(), 1);
  return continue_as("e2lf-train", std::move(arguments),
                     "`./run train` and `./run resume` build it, or install libtorch-dev, configure again and rebuild");
}

}  // namespace

int run_train(const std::vector<std::string>& arguments) {
  Verb verb("train",
            "Learn the aperture patterns and the network jointly. docs/training.md describes the configuration, whose "
            "keys --set changes (--set seed=7, --set device=cuda).",
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

namespace fs = std::filesystem;

int run_pack(const std::vector<std::string>& arguments) {
  Verb verb("pack", "Pack light fields and photographs into one file for training, 8-bit grey.",
            "e2lf pack scenes/* --textures photos/ -o packed.safetensors");
  learn::PackOptions options;
  fs::path output;
  CLI::App& app = verb.app();
  app.add_option("light-fields,-i,--input", options.light_fields, "light fields of any kind that e2lf reads")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--textures", options.textures, "photographs, or folders of photographs, for synthesised light fields")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_flag("--disparity", options.estimate_disparity,
               "estimate disparities of light fields, to train networks of disparity; true ones beside the views "
               "(gt_disparity.npy) are always packed");
  app.add_option("-o,--output", output, "file to write (.safetensors)")->required();
  return verb.run(arguments, [&]() -> Result<void> {
    std::vector<fs::path> inputs = options.light_fields;
    inputs.insert(inputs.end(), options.textures.begin(), options.textures.end());
    E2LF_ASSIGN_OR_RETURN(OutputFile file, open_output(output, verb, ".safetensors"));
    RunRecord record(verb, inputs);
    ProgressBar bar("pack", verb.common().quiet);
    E2LF_ASSIGN_OR_RETURN(const auto summary, learn::pack(file.path(), options, bar.callback()));
    hide_progress();
    record.end_step("pack");
    E2LF_RETURN_IF_ERROR(commit(file, record));
    print_result(
        verb.common(),
        {{"light_fields", summary.light_fields},
         {"with_disparity", summary.with_disparity},
         {"textures", summary.textures},
         {"bytes", summary.bytes}},
        formatted("packed %zu light fields (%zu with disparities) and %zu photographs, %.0f MB\n", summary.light_fields,
                  summary.with_disparity, summary.textures, static_cast<double>(summary.bytes) / 1e6));
    return {};
  });
}

}  // namespace e2lf::cli
