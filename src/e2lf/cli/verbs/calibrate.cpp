// SPDX-License-Identifier: MIT
// e2lf calibrate: estimates the constants of a camera from event images of static scenes
#include "e2lf/calibrate/calibrate.h"

#include <algorithm>
#include <optional>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/cli/flags/event_flags.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/files/file.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/model/model.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/options.h"
#include "e2lf/program/outputs.h"
#include "e2lf/recon/scene_motion.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

struct CalibrateArguments {
  std::vector<fs::path> inputs;
  fs::path output;
  CodesSource codes;
  std::string camera = "evk4-lcos", name;
  std::vector<std::string> held;
  bool is_even = false;
  CycleFlags cycles;
};

/// Reads all cycles of an input, and takes over the patterns that it states. Fails if `codes` are other ones, which an
/// input before has stated.
Result<calibrate::StillScene> read_scene(const fs::path& path, const CycleFlags& flags, const Verb& verb,
                                         RunRecord& record, std::optional<capture::Codes>& codes) {
  E2LF_ASSIGN_OR_RETURN(pipeline::CycleInput input, open_cycle_input(path, flags, verb));
  if (input.measurement() != capture::MeasurementKind::kEventImages) {
    return fail(ErrorCode::kInvalidValue, path, "a calibration requires event images, but this is the measurement ",
                capture::measurement_name(input.measurement()), "; give a recording or event images");
  }
  E2LF_ASSIGN_OR_RETURN(capture::RecordedSetup setup, input.setup());
  diagnose::log_findings(path.string(), diagnose::findings_from_text(setup.findings));
  if (codes && setup.codes && *codes != *setup.codes) {
    return fail(ErrorCode::kInvalidValue, path,
                "the inputs were recorded with different patterns; calibrate from each separately");
  }
  if (setup.codes) codes = std::move(setup.codes);
  calibrate::StillScene scene;
  while (true) {
    E2LF_ASSIGN_OR_RETURN(std::optional<pipeline::CycleImages> cycle, input.next());
    if (!cycle) break;
    scene.cycles.push_back(std::move(cycle->images.events));
  }
  if (input.is_recording() && scene.cycles.empty()) return no_cycle_error(path, input.rig(), input.reader());
  if (input.is_recording()) diagnose::log_findings(path.string(), input.rig().findings(input.reader()));
  record.add_input(path);
  return scene;
}

/// Makes the patterns and the events those of the same transitions: patterns of a whole cycle for its events, and with
/// --transitions lit only the lit ones of both.
void match_transitions(const std::string& wanted, capture::Codes& codes, std::vector<calibrate::StillScene>& scenes) {
  const auto have = [&](size_t transitions) {
    return std::ranges::all_of(scenes, [&](const calibrate::StillScene& scene) {
      return std::ranges::all_of(scene.cycles, [&](const auto& cycle) { return cycle.count == transitions; });
    });
  };
  if (have(2 * codes.num_patterns)) codes = capture::whole_cycle(codes);
  const auto of_whole = capture::codes_of_whole_cycle(codes);
  if (wanted != "lit" || !of_whole || !have(codes.num_patterns - 1)) return;
  codes = *of_whole;
  for (calibrate::StillScene& scene : scenes) {
    for (capture::EventImages& cycle : scene.cycles) cycle = recon::lit_transitions(cycle);
  }
}

std::string next_step(const CalibrateArguments& arguments, const Verb& verb) {
  std::string command = cat("e2lf reconstruct ", shell_word(arguments.inputs.front()));
  const auto add = [&](const char* option, const fs::path& path) {
    if (!path.empty()) command += cat(" ", option, " ", shell_word(path));
  };
  add("-m", arguments.codes.model);
  add("--codes", arguments.codes.codes);
  command +=
      verb.text_of_options({kCycleOptions, kRecordingOptions, kTableOptions, "--transitions", "--invert-polarity"});
  add("--camera", arguments.output);
  add("-o", arguments.output.stem());
  return command;
}

Result<void> calibrate_camera(const CalibrateArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  E2LF_ASSIGN_OR_RETURN(OutputFile output, open_output(arguments.output, verb, ".json"));
  RunRecord record(verb);
  E2LF_ASSIGN_OR_RETURN(capture::SensorProfile start, load_camera(arguments.camera, record));
  std::vector<calibrate::StillScene> scenes;
  std::optional<capture::Codes> stated;
  for (const fs::path& path : arguments.inputs) {
    if (std::ranges::count(arguments.inputs, path) > 1) {
      return fail(ErrorCode::kInvalidValue, path, "the same events cannot determine a camera twice; name them once");
    }
    E2LF_ASSIGN_OR_RETURN(calibrate::StillScene scene, read_scene(path, arguments.cycles, verb, record, stated));
    scenes.push_back(std::move(scene));
  }
  E2LF_ASSIGN_OR_RETURN(const std::optional<model::Model> model, read_named_model(arguments.codes, record));
  E2LF_ASSIGN_OR_RETURN(std::optional<pipeline::KnownCodes> known, find_codes(arguments.codes, model, stated, record));
  if (!known) return fail(ErrorCode::kNotFound, "", "the patterns of the events are not known; give --codes FILE");
  match_transitions(arguments.cycles.events.schedule.transitions, known->codes, scenes);
  start.name = arguments.name.empty() ? arguments.output.stem().string() : arguments.name;
  record.end_step("read");

  ProgressBar bar("calibrate", common.quiet || common.json);
  E2LF_ASSIGN_OR_RETURN(
      const calibrate::Calibration calibration,
      calibrate::calibrate(scenes, known->codes, start,
                           {.held = arguments.held, .is_even = arguments.is_even, .progress = bar.callback()}));
  record.end_step("calibrate");
  for (const std::string& warning : calibration.warnings) log_warning(warning);
  const Json report = calibrate::report_json(calibration);
  record.note("report", report);
  E2LF_RETURN_IF_ERROR(write_file(output.path(), calibrate::camera_json(calibration).dump(2) + "\n"));
  E2LF_RETURN_IF_ERROR(commit(output, record));
  print_result(common, report, calibrate::report_text(calibration));
  print_next_step(next_step(arguments, verb), common);
  return {};
}

}  // namespace

int run_calibrate(const std::vector<std::string>& arguments) {
  Verb verb("calibrate",
            "Estimate the constants of an event camera behind a coded aperture from event images or recordings of "
            "static scenes.",
            "e2lf calibrate events.npz --codes codes.json -o camera.json");
  CalibrateArguments calibration;
  CLI::App& app = verb.app();
  app.add_option("inputs,-i,--input", calibration.inputs,
                 "event images or recordings of static scenes; all cycles of each show the same scene")
      ->required();
  app.add_option("-o,--output", calibration.output, "camera file to write (JSON)")->required();
  add_codes_options(app, calibration.codes);
  add_camera_option(app, calibration.camera,
                    "camera to start from; constants that the data do not determine keep its values");
  app.add_option("--name", calibration.name, "name of the camera; default: the name of the file");
  app.add_option("--hold", calibration.held,
                 "constants that keep the value of the starting camera, e.g. receptor_rate_hz or transmission[1]")
      ->delimiter(',');
  app.add_flag("--even", calibration.is_even,
               "the scenes are known to be uniform, e.g. a card that fills the image: do not search for flat areas");
  add_cycle_options(app, calibration.cycles);
  return verb.run(arguments, [&] { return calibrate_camera(calibration, verb); });
}

}  // namespace e2lf::cli
