// SPDX-License-Identifier: MIT
// e2lf eval: a reconstruction against the truth
#include <cstdio>
#include <optional>

#include "e2lf/capture/event_images.h"
#include "e2lf/cli/inputs.h"
#include "e2lf/cli/output.h"
#include "e2lf/cli/run_record.h"
#include "e2lf/cli/verb.h"
#include "e2lf/eval/metrics.h"
#include "e2lf/eval/report.h"
#include "e2lf/files/json_text.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

struct EvalArguments {
  fs::path truth, reconstruction, events, output;
  bool no_clamp = false, csv = false;
};

void print_result(const eval::EvalRow& row, const EvalArguments& arguments, const CommonOptions& common) {
  if (common.json) {
    Json json = eval::to_json(row.quality);
    if (row.events) json["events"] = eval::to_json(*row.events);
    std::printf("%s", json_text(json).c_str());
  } else if (arguments.csv) {
    std::printf("%s", eval::csv_text({&row, 1}).c_str());
  } else if (!common.quiet) {
    std::printf("%s\nPSNR of each view in dB:\n%s", eval::table_text({&row, 1}).c_str(),
                eval::view_grid_text(row.quality).c_str());
  }
}

Result<void> evaluate(const EvalArguments& arguments, const Verb& verb) {
  const bool quiet = verb.common().quiet;
  std::optional<OutputFile> output;
  if (!arguments.output.empty()) {
    E2LF_ASSIGN_OR_RETURN(
        output,
        OutputFile::create(arguments.output, {.inputs = {arguments.truth, arguments.reconstruction, arguments.events},
                                              .overwrite = verb.common().overwrite,
                                              .ending = ".json",
                                              .streams = true}));
  }
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightField truth, load_scene(arguments.truth, {}, quiet));
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightField reconstruction,
                        load_reconstruction(arguments.reconstruction, quiet));
  eval::EvalRow row{arguments.reconstruction.string(), arguments.truth.string(), {}, {}};
  {
    ProgressBar bar("compare", quiet);
    E2LF_ASSIGN_OR_RETURN(row.quality,
                          eval::compare(truth, reconstruction, {.clamp = !arguments.no_clamp}, bar.callback()));
  }
  if (!arguments.events.empty()) {
    E2LF_ASSIGN_OR_RETURN(const capture::EventImageFile file, capture::read_event_images(arguments.events));
    const capture::EventImages& images = file.cycles.front();
    if (images.width != truth.shape().width || images.height != truth.shape().height) {
      return Error{ErrorCode::kShape,
                   cat("event images of ", images.width, "x", images.height, " px are not of a light field of ",
                       truth.shape().width, "x", truth.shape().height, " px; give those it was made from"),
                   arguments.events.string()};
    }
    row.events = eval::event_statistics(images);
  }
  if (output) {
    E2LF_RETURN_IF_ERROR(write_file(output->path(), json_text(eval::to_json(row))));
    E2LF_RETURN_IF_ERROR(output->commit());
  }
  print_result(row, arguments, verb.common());
  return {};
}

}  // namespace

int run_eval(const std::vector<std::string>& arguments) {
  Verb verb("eval",
            "Compare a reconstructed light field with the true one: PSNR and SSIM of each view and their means.",
            "e2lf eval scene/ out/recon --events events.npz --json");
  EvalArguments evaluation;
  CLI::App& app = verb.app();
  app.add_option("truth", evaluation.truth, "the true light field")->required();
  app.add_option("reconstruction", evaluation.reconstruction, "the reconstructed light field")->required();
  app.add_option("--events", evaluation.events, "event images: adds event counts, measurement time and data rate");
  app.add_option("-o,--output", evaluation.output, "also write the result to this JSON file");
  app.add_flag("--csv", evaluation.csv, "print comma-separated values");
  app.add_flag("--no-clamp", evaluation.no_clamp, "do not clamp the reconstruction to [0, 1] before measuring");
  return verb.run(arguments, [&] { return evaluate(evaluation, verb); });
}

}  // namespace e2lf::cli
