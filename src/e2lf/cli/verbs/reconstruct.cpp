// SPDX-License-Identifier: MIT
// e2lf reconstruct: reconstructs light fields from event images or a recording
#include <filesystem>
#include <string>

#include "e2lf/base/text.h"
#include "e2lf/cli/flags/event_flags.h"
#include "e2lf/cli/output/results.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/files/options.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/lightfield/light_field_io.h"
#include "e2lf/lightfield/views.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/outputs.h"
#include "e2lf/program/sibling_program.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

constexpr Choice<pipeline::Algorithm> kMethods[] = {{"network", pipeline::Algorithm::kNetwork},
                                                    {"inversion", pipeline::Algorithm::kInversion}};

struct ReconstructArguments {
  fs::path input, output;
  MethodFlags method;
  std::string format = "png";
  CycleFlags cycles;
  OrientationFlags orientation;
};

/// Returns the orientation in which the views are written, for the records.
Json views_json(const pipeline::EventRun& run, const std::string& format) {
  if (!run.views()) return Json::object();
  const capture::Orientation stored = format == "npy" ? *run.views() : capture::Orientation{};
  return {{"views", lightfield::views_note(*run.views(), stored)}};
}

/// Returns the lines that tell the user of the light fields, of which the first has this text about its events.
std::string result_text(const ReconstructArguments& arguments, bool is_one, size_t light_fields,
                        const pipeline::Tone& tone, const std::string& of_first) {
  const fs::path first = is_one ? arguments.output : arguments.output / cycle_name(0);
  return cat(counted(light_fields, "light field"), " in ", first.string(),
             light_fields == 1 ? "" : cat(" ... ", cycle_name(light_fields - 1)),
             formatted(" (black %.3g, gain %.3g): ", tone.black.value_or(0.0F), tone.gain.value_or(1.0F)),
             arguments.format == "npy" ? "lightfield.npy" : "views", ", contact_sheet.png, epi.png, run.json\n",
             of_first);
}

Result<void> reconstruct(const ReconstructArguments& arguments, const Verb& verb) {
  // Before there is an output, because the program that continues would find it unfinished.
  E2LF_RETURN_IF_ERROR(require_device(arguments.method.choice.device));
  E2LF_ASSIGN_OR_RETURN(ResultFolder folder, open_output_folder(arguments.output, verb));
  RunRecord record(verb);
  E2LF_ASSIGN_OR_RETURN(pipeline::EventRun run, open_event_run(arguments.input, arguments.cycles, arguments.method,
                                                               arguments.orientation, verb, record));
  EventRunLog log(run, arguments.input, record);
  const Json views = views_json(run, arguments.format);
  ResultParts parts(std::move(folder), run.input().has_one_field(), arguments.cycles.recording.is_strict);
  Json cycles = Json::array();
  std::string of_first;
  const auto step = [&](size_t number) -> Result<bool> {
    const std::string name = cycle_name(number);
    // For live input, the log has a line for each cycle instead.
    ProgressBar bar("reconstruct " + name, verb.common().quiet || is_live(arguments.input));
    E2LF_ASSIGN_OR_RETURN(std::optional<pipeline::EventResult> result, run.next(bar.callback()));
    if (!result) return false;
    hide_progress();
    E2LF_ASSIGN_OR_RETURN(const fs::path place, parts.begin(name));
    E2LF_RETURN_IF_ERROR(write_reconstruction(place, std::get<pipeline::Field>(result->made).light_field,
                                              arguments.format, run.views().value_or(capture::Orientation{}), {}));
    if (number == 0) of_first = event_error_text(*result);
    cycles.push_back(log.add(*result));
    Json about = {{"cycle", cycles.back()}, {"notes", views}};
    E2LF_RETURN_IF_ERROR(parts.commit(name, std::move(about), record));
    return true;
  };
  E2LF_RETURN_IF_ERROR(repeat_until_stopped(step));
  E2LF_ASSIGN_OR_RETURN(Json printed, log.finish(verb, record));
  record.end_step("reconstruct");
  // If no cycle has events, gain and black level are not determined.
  const pipeline::EventRunReport report = run.report();
  record.resolve("gain", json_number(report.tone.gain.value_or(1.0F)));
  record.resolve("black", json_number(report.tone.black.value_or(0.0F)));
  record.note(views);
  record.note("cycles", cycles);
  E2LF_RETURN_IF_ERROR(parts.finish(record));
  printed.update({{"output", arguments.output.string()}, {"cycles", cycles}});
  print_result(verb.common(), printed,
               result_text(arguments, run.input().has_one_field(), report.results, report.tone, of_first));
  print_next_step(cat("e2lf view ", shell_word(arguments.output)), verb.common());
  return {};
}

}  // namespace

int run_reconstruct(const std::vector<std::string>& arguments) {
  Verb verb(
      "reconstruct", "Reconstruct the light field of each pattern cycle from its event images.",
      "e2lf reconstruct events.npz -m MODEL.safetensors -o out/recon    (MODEL: trained for the camera's patterns)");
  ReconstructArguments reconstruction;
  CLI::App& app = verb.app();
  app.add_option("input,-i,--input", reconstruction.input,
                 "event images (.npz, .npy, folder of event_image_00000.npy ...), a recording, - for standard input, "
                 "tcp://127.0.0.1:PORT, camera://NAME, or replay:FILE (a recording at its own speed)")
      ->required();
  app.add_option("-o,--output", reconstruction.output, "folder to write")->required();
  add_method_options(app, reconstruction.method, "the file of the events");
  add_tone_options(app, reconstruction.method);
  add_choice(app, "--method", reconstruction.method.choice.algorithm, kMethods,
             "network, or inversion in closed form, which needs no model, only patterns");
  add_count(app, "--passes", reconstruction.method.choice.use.passes, 1, 64,
            "number of runs of the network at shifted positions whose results are averaged: better quality, but "
            "proportionally slower (the paper's network supports only 1)");
  add_count(app, "--cycles-per-field", reconstruction.method.choice.use.cycles, 1, 64,
            "number of cycles of a static scene from which each light field is reconstructed: better with each "
            "doubling; for networks conditioned on the sensor profile");
  add_fuse_option(app, reconstruction.method.choice.use.fused_cycles, "light field");
  add_choice(app, "--format", reconstruction.format, {"png", "png16", "npy"},
             "png, png16 (64 views) or npy (float32 [8, 8, y, x], not clamped)");
  add_cycle_options(app, reconstruction.cycles);
  add_orientation_options(app, reconstruction.orientation);
  verb.stop_gently();
  return verb.run(arguments, [&] { return reconstruct(reconstruction, verb); });
}

}  // namespace e2lf::cli
