// SPDX-License-Identifier: MIT
// e2lf pack: light fields and photographs -> one file for training
#include "e2lf/learn/data/pack.h"

#include "e2lf/base/format.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/program/run_record.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
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
  app.add_option("-o,--output", output, "file to write (.safetensors)")->required();
  return verb.run(arguments, [&]() -> Result<void> {
    std::vector<fs::path> inputs = options.light_fields;
    inputs.insert(inputs.end(), options.textures.begin(), options.textures.end());
    E2LF_ASSIGN_OR_RETURN(OutputFile file, open_output(output, verb, inputs, ".safetensors"));
    RunRecord record("pack", inputs);
    ProgressBar bar("pack", verb.common().quiet);
    E2LF_ASSIGN_OR_RETURN(const auto summary, learn::pack(file.path(), options, bar.callback()));
    hide_progress();
    record.end_step("pack");
    E2LF_RETURN_IF_ERROR(commit(file, record, verb));
    print_result(verb.common(),
                 {{"light_fields", summary.light_fields}, {"textures", summary.textures}, {"bytes", summary.bytes}},
                 formatted("packed %zu light fields and %zu photographs, %.0f MB\n", summary.light_fields,
                           summary.textures, static_cast<double>(summary.bytes) / 1e6));
    return {};
  });
}

}  // namespace e2lf::cli
