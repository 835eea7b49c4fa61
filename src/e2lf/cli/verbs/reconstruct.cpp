// SPDX-License-Identifier: MIT
// e2lf reconstruct: reconstructs light fields from event images or a recording
#include <algorithm>
#include <optional>

#include "e2lf/base/log.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/flags/cycle_options.h"
#include "e2lf/cli/flags/method_flags.h"
#include "e2lf/cli/output/light_field_writer.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/files/options.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/run_record.h"
#include "e2lf/program/sibling_program.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using lightfield::LightField;
namespace {

struct ReconstructArguments {
  fs::path input, output;
  MethodFlags method_flags;
  std::string method = "network", format = "png";
  size_t passes = 1, cycles_per_field = 1, fuse = 1;
  CycleFlags cycles;
  OrientationFlags orientation;
};

/// Writes a single cycle to the folder itself. Of several cycles, each has a folder, which appears complete when the
/// cycle is done, so that it can be used while later ones are computed. The output folder appears with the first cycle,
/// so that an input without cycles replaces nothing, or with --strict at the end, when it is known that no data were
/// left out.
Result<void> process_cycles(pipeline::CycleInput& input, LightFieldWriter& writer, ResultFolder& output,
                            const RunRecord& record, const ReconstructArguments& arguments) {
  const bool is_strict = arguments.cycles.recording.is_strict;
  while (writer.cycles().empty() || !stop_requested()) {
    E2LF_ASSIGN_OR_RETURN(const std::optional<pipeline::CycleImages> images, input.next());
    if (!images) break;
    const bool first = writer.cycles().empty(), is_all = input.has_one_field();
    const std::string name = cycle_name(writer.cycles().size());
    fs::path folder = output.path();
    if (!is_all) {
      E2LF_ASSIGN_OR_RETURN(folder, output.begin_part(name));
    }
    E2LF_RETURN_IF_ERROR(writer.process(*images, folder));
    const Json& cycle = writer.cycles().back();
    if (!is_all) E2LF_RETURN_IF_ERROR(output.commit_part(name, {{"cycle", cycle}, {"notes", writer.notes()}}));
    if (first && !is_all && !is_strict) E2LF_RETURN_IF_ERROR(output.commit(record.json_so_far()));
    if (is_all) return {};
  }
  return {};
}

void print_light_fields(const ReconstructArguments& arguments, const CommonOptions& common,
                        const pipeline::CycleInput& input, const Json& cycles) {
  // Each cycle of a recording, or of several, has its own folder.
  const bool has_one = input.has_one_field();
  const fs::path first = has_one ? arguments.output : arguments.output / cycle_name(0);
  const Json& cycle = cycles.front();
  const std::string text =
      cat(counted(cycles.size(), "light field"), " in ", first.string(),
          cycles.size() == 1 ? "" : cat(" ... ", cycle_name(cycles.size() - 1)),
          formatted(" (black %.3g, gain %.3g): ", cycle["black"].get<double>(), cycle["gain"].get<double>()),
          arguments.format == "npy" ? "lightfield.npy" : "views", ", contact_sheet.png, epi.png, run.json\n",
          cycle.contains("event_error") ? event_error_text(cycle) : "");
  print_result(common,
               {{"output", arguments.output.string()}, {"cycles", cycles}, {"left_out", losses_json(input.summary())}},
               text);
  print_next_step(cat("e2lf view ", shell_word(arguments.output.string())), common);
}

/// Logs how many light fields were reconstructed from the lit transitions because the scene moved.
void say_motion(const fs::path& input, const Json& cycles, const std::string& network) {
  const auto moving = std::count_if(cycles.begin(), cycles.end(),
                                    [](const Json& cycle) { return cycle.value("transitions", "") == "lit"; });
  if (moving == 0) return;
  log_info(cat(input.string(), ": the scene moved during ", moving, " of ", cycles.size(), " cycles, which ", network,
               " reconstructed from their lit transitions; --transitions all uses the whole cycle in every case"));
}

Result<void> reconstruct(const ReconstructArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  const MethodFlags& flags = arguments.method_flags;
  // Before there is an output, because the program that continues would find it unfinished.
  E2LF_RETURN_IF_ERROR(find_device(flags.device));
  E2LF_ASSIGN_OR_RETURN(ResultFolder output, open_output_folder(arguments.output, verb, {arguments.input}));
  RunRecord record(verb);
  E2LF_ASSIGN_OR_RETURN(pipeline::MethodChoice choice, named_choice(flags, record));
  choice.algorithm = arguments.method;
  choice.lit_where_moving = arguments.cycles.choice.transitions == "auto";
  diagnose::RigCheck rig;
  E2LF_ASSIGN_OR_RETURN(pipeline::CycleInput input,
                        open_cycle_input(arguments.input, wanted_cycles(arguments.cycles, choice),
                                         arguments.cycles_per_field, verb, rig));
  if (input.is_without_events()) {
    return fail(ErrorCode::kInvalidValue, arguments.input,
                "there are no events to reconstruct from: all counts are 0; check how they were accumulated");
  }
  if (!input.is_recording() && arguments.cycles.choice.transitions == "lit") {
    return fail(ErrorCode::kInvalidValue, "--transitions lit",
                "only applies to recordings, not to event images; leave it out");
  }
  choice.measurement = input.measurement();
  choice.transitions = input.transitions();
  E2LF_ASSIGN_OR_RETURN(capture::RecordedSetup setup, input.setup(arguments.input));
  // Their remedies are options of accumulate, because wrong times and signs select other events.
  const diagnose::Findings recorded = diagnose::findings_from_text(setup.findings);
  diagnose::log_findings(cat(arguments.input.string(), ": when it was accumulated"), recorded);
  if (choice.codes && input.is_recording()) {
    choice.codes = cycles::codes_of_images(*choice.codes, input.reader().schedule()).value_or(*choice.codes);
  }
  E2LF_RETURN_IF_ERROR(complete_choice(flags, std::move(setup), record, choice));
  E2LF_ASSIGN_OR_RETURN(const pipeline::OpenedMethod method,
                        by_flag(pipeline::open_method(std::move(choice)), arguments.input));
  if (arguments.fuse > 1) {
    E2LF_RETURN_IF_ERROR(by_flag(input.fuse(method.sensor(), arguments.fuse), arguments.input));
  }
  const pipeline::MethodUse use{
      .passes = arguments.passes, .cycles = arguments.cycles_per_field, .fused_cycles = arguments.fuse};
  E2LF_ASSIGN_OR_RETURN(const pipeline::Tone tone, tone_of(flags));
  E2LF_ASSIGN_OR_RETURN(pipeline::FieldSequence sequence,
                        by_flag(pipeline::open_sequence(method, use, tone), arguments.input));
  E2LF_ASSIGN_OR_RETURN(std::optional<diagnose::FieldCheck> check, diagnose::FieldCheck::create(method, use));
  note_method(method, arguments.input, flags.codes.model, arguments.passes, record);
  record.end_step("open");
  LightFieldWriter writer({.input = arguments.input,
                           .format = arguments.format,
                           .is_quiet = common.quiet,
                           .views = arguments.orientation.after(method.views),
                           .codes = method.codes_of_signs(),
                           .check = std::move(check),
                           .cycles_per_field = arguments.cycles_per_field,
                           .is_confirmed = !diagnose::has_doubt(recorded)},
                          std::move(sequence));
  E2LF_RETURN_IF_ERROR(process_cycles(input, writer, output, record, arguments));
  warn_of_losses(arguments.input, input.summary());
  verb.note_failed_input(input.summary().live.failure);
  if (!writer.cycles().empty()) log_check(arguments.input, writer.cycles().front());
  if (method.lit) say_motion(arguments.input, writer.cycles(), method.lit->model().name);
  if (input.is_recording()) {
    const cycles::CycleReader& reader = input.reader();
    writer.live_log().finish(reader.report());
    if (writer.cycles().empty()) return no_cycle_error(arguments.input, rig, reader);
    diagnose::log_findings(arguments.input.string(), rig.findings(reader));
    record.resolve("source", word_of(reader.source(), kCycleSources));
    record.note("found", report_json(rig, reader));
    record.note(reading_notes(arguments.input, reader.recording().info()));
  }
  record.note("left_out", losses_json(input.summary()));
  record.note("live", live_json(input.summary()));
  record.note(writer.notes());
  record.end_step("reconstruct");
  // If no cycle has events, gain and black level are not determined.
  record.resolve("gain", json_number(writer.tone().gain.value_or(1.0F)));
  record.resolve("black", json_number(writer.tone().black.value_or(0.0F)));
  record.note("cycles", writer.cycles());
  record.add_input(arguments.input);
  E2LF_ASSIGN_OR_RETURN(Json about, record.json());
  const bool is_at_end = input.has_one_field() || arguments.cycles.recording.is_strict;
  E2LF_RETURN_IF_ERROR(is_at_end ? output.commit(std::move(about)) : output.update_record(std::move(about)));
  print_light_fields(arguments, common, input, writer.cycles());
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
  add_method_options(app, reconstruction.method_flags, "the file of the events");
  add_tone_options(app, reconstruction.method_flags);
  add_choice(app, "--method", reconstruction.method, {"network", "inversion"},
             "network, or inversion in closed form, which needs no model, only patterns");
  add_count(app, "--passes", reconstruction.passes, 1, 64,
            "number of runs of the network at shifted positions whose results are averaged: better quality, but "
            "proportionally slower (the paper's network supports only 1)");
  add_count(app, "--cycles-per-field", reconstruction.cycles_per_field, 1, 64,
            "number of cycles of a static scene from which each light field is reconstructed: better with each "
            "doubling; for networks conditioned on the sensor profile");
  add_fuse_option(app, reconstruction.fuse, "light field");
  add_choice(app, "--format", reconstruction.format, {"png", "png16", "npy"},
             "png, png16 (64 views) or npy (float32 [8, 8, y, x], not clamped)");
  add_cycle_options(app, reconstruction.cycles);
  add_orientation_options(app, reconstruction.orientation);
  verb.stop_gently();
  return verb.run(arguments, [&] { return reconstruct(reconstruction, verb); });
}

}  // namespace e2lf::cli
