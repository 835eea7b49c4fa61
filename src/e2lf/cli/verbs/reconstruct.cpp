// SPDX-License-Identifier: MIT
// e2lf reconstruct: reconstructs light fields from event images or a recording
#include <algorithm>
#include <cstdio>
#include <optional>

#include "e2lf/base/log.h"
#include "e2lf/base/stop.h"
#include "e2lf/base/text.h"
#include "e2lf/cli/flags/camera_option.h"
#include "e2lf/cli/flags/cycle_input.h"
#include "e2lf/cli/flags/cycle_options.h"
#include "e2lf/cli/flags/inputs.h"
#include "e2lf/cli/flags/number_check.h"
#include "e2lf/cli/output/cycle_writer.h"
#include "e2lf/cli/output/event_verdict.h"
#include "e2lf/cli/output/light_field_output.h"
#include "e2lf/cli/output/method_notes.h"
#include "e2lf/cli/output/next_step.h"
#include "e2lf/cli/output/output.h"
#include "e2lf/cli/output/run_record.h"
#include "e2lf/cli/verb.h"
#include "e2lf/cli/verbs/live_view.h"
#include "e2lf/files/options.h"
#include "e2lf/pipeline/method.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
using lightfield::LightField;
namespace {

struct ReconstructArguments {
  fs::path input, output;
  CodesSource codes;
  std::string method = "network", precision = "auto", gain = "auto", black = "auto", format = "png", camera,
              colour_filter;
  size_t passes = 1, cycles_per_field = 1;
  bool view = false;
  uint16_t port = 0;
  CycleFlags cycles;
  OrientationFlags orientation;
};

/// Returns the note that is shown beside a cycle: its latency if the input is live, or else the time it took.
std::string note_of(const Json& cycle, bool is_live) {
  char text[80];
  std::snprintf(text, sizeof text, is_live ? "latency %.3f s" : "reconstructed in %.3f s",
                cycle[is_live ? "latency_s" : "reconstruct_s"].get<double>());
  return text;
}

/// Writes a single cycle to the folder itself. Of several cycles, each has a folder, which appears complete when the
/// cycle is done, so that it can be used while later ones are computed. The output folder appears with the first cycle,
/// so that an input without cycles replaces nothing, or with --strict at the end, when it is known that no data were
/// left out.
Result<void> process_cycles(pipeline::CycleInput& input, CycleWriter& writer, ResultFolder& output,
                            const RunRecord& record, const ReconstructArguments& arguments, LiveView* view,
                            const Verb& verb) {
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
    E2LF_ASSIGN_OR_RETURN(LightField light_field, writer.process(*images, folder));
    const Json& cycle = writer.cycles().back();
    if (!is_all) E2LF_RETURN_IF_ERROR(output.commit_part(name, {{"cycle", cycle}, {"notes", writer.notes()}}));
    const bool appears = first && !is_all && !is_strict;
    if (appears) E2LF_RETURN_IF_ERROR(output.commit(record.json_so_far(verb)));
    // A cycle that is shown in the browser must have been written.
    if (view != nullptr) view->add(name, std::move(light_field), note_of(cycle, images->is_live()));
    if (view != nullptr && appears) view->set_folder(arguments.output);
    if (is_all) return {};
  }
  return {};
}

/// Returns the location of the views for messages. Each cycle of a recording, or of several, has its own folder.
std::string place_of_views(const fs::path& output, bool has_one_cycle, size_t cycles) {
  if (has_one_cycle) return output.string();
  const std::string first = (output / cycle_name(0)).string();
  return cycles == 1 ? first : cat(first, " ... ", cycle_name(cycles - 1));
}

std::string next_step(const ReconstructArguments& arguments, bool has_one_cycle) {
  if (has_viewer()) return cat("e2lf view ", shell_word(arguments.output.string()));
  const fs::path views = has_one_cycle ? arguments.output : arguments.output / cycle_name(0);
  return cat("look at ", (views / "contact_sheet.png").string());
}

void print_result(const ReconstructArguments& arguments, const CommonOptions& common, const pipeline::CycleInput& input,
                  const Json& cycles) {
  if (common.json) {
    const Json result = {
        {"output", arguments.output.string()}, {"cycles", cycles}, {"left_out", losses_json(input.summary())}};
    std::printf("%s", json_text(result).c_str());
  } else if (!common.quiet) {
    const std::string where = place_of_views(arguments.output, input.has_one_field(), cycles.size());
    std::printf("%zu light field%s in %s (black %.3g, gain %.3g): %s, contact_sheet.png, epi.png, run.json\n",
                cycles.size(), cycles.size() == 1 ? "" : "s", where.c_str(), cycles.front()["black"].get<double>(),
                cycles.front()["gain"].get<double>(), arguments.format == "npy" ? "lightfield.npy" : "views");
    if (cycles.front().contains("event_error")) print_event_error(cycles.front());
    if (!arguments.view) print_next_step(next_step(arguments, input.has_one_field()), common);
  }
}

/// Logs how many light fields were reconstructed from the lit transitions because the scene moved.
void say_motion(const fs::path& input, const Json& cycles, const std::string& network) {
  const auto moving = std::count_if(cycles.begin(), cycles.end(),
                                    [](const Json& cycle) { return cycle.value("transitions", "") == "lit"; });
  if (moving == 0) return;
  log_info(cat(input.string(), ": the scene moved during ", moving, " of ", cycles.size(), " cycles, which ", network,
               " reconstructed from their lit transitions; --transitions all uses the whole cycle in every case"));
}

Result<pipeline::OpenedMethod> choose_method(const ReconstructArguments& arguments, const pipeline::CycleInput& input,
                                             pipeline::MethodChoice choice, RunRecord& record) {
  choice.measurement = input.measurement();
  E2LF_ASSIGN_OR_RETURN(choice.events, input.setup(arguments.input));
  if (!arguments.camera.empty()) {
    E2LF_ASSIGN_OR_RETURN(choice.camera, load_camera(arguments.camera, record));
  }
  note_named_codes(arguments.codes, choice.codes, choice.events.codes, record);
  auto method = pipeline::open_method(std::move(choice));
  if (!method) return by_flag(method.error(), arguments.input);
  return method;
}

Result<pipeline::FieldSequence> start_sequence(const ReconstructArguments& arguments,
                                               const pipeline::OpenedMethod& method, const pipeline::MethodUse& use) {
  pipeline::Tone tone;
  E2LF_ASSIGN_OR_RETURN(tone.gain, parse_gain(arguments.gain));
  E2LF_ASSIGN_OR_RETURN(tone.black, parse_black(arguments.black));
  auto sequence = pipeline::open_sequence(method, use, tone, /*is_checked=*/true);
  if (!sequence) return by_flag(sequence.error(), arguments.input);
  return sequence;
}

Result<void> reconstruct(const ReconstructArguments& arguments, const Verb& verb) {
  if (arguments.port != 0 && !arguments.view) {
    return Error{ErrorCode::kInvalidValue, "a port is only used by --view; leave it out, or add --view", "--port"};
  }
  const CommonOptions& common = verb.common();
  const OutputRules rules{.inputs = {arguments.input, arguments.codes.model, arguments.codes.codes,
                                     arguments.cycles.schedule, arguments.camera},
                          .overwrite = common.overwrite};
  E2LF_ASSIGN_OR_RETURN(ResultFolder output, open_output_folder(arguments.output, rules));
  RunRecord record("reconstruct");
  pipeline::MethodChoice choice{.algorithm = arguments.method,
                                .precision = arguments.precision,
                                .lit_where_moving = arguments.cycles.transitions == "auto"};
  E2LF_ASSIGN_OR_RETURN(choice.model, read_named_model(arguments.codes, record));
  E2LF_ASSIGN_OR_RETURN(choice.codes, read_named_codes(arguments.codes));
  ConfidenceWatch confidence;
  E2LF_ASSIGN_OR_RETURN(pipeline::CycleInput input,
                        open_cycle_input(arguments.input, wanted_cycles(arguments.cycles, choice),
                                         arguments.cycles_per_field, verb, confidence));
  if (input.is_without_events()) {
    return Error{ErrorCode::kInvalidValue,
                 "there are no events to reconstruct from: all counts are 0; check how they were accumulated",
                 arguments.input.string()};
  }
  if (!input.is_recording() && arguments.cycles.transitions == "lit") {
    return Error{ErrorCode::kInvalidValue, "does nothing for event images; leave it out", "--transitions lit"};
  }
  E2LF_ASSIGN_OR_RETURN(const pipeline::OpenedMethod method,
                        choose_method(arguments, input, std::move(choice), record));
  const std::string recorded_filter = pipeline::recorded_colour_filter(arguments.input);
  const pipeline::MethodUse use{
      .passes = arguments.passes,
      .cycles = arguments.cycles_per_field,
      .colour_filter = arguments.colour_filter.empty() ? recorded_filter : arguments.colour_filter};
  E2LF_ASSIGN_OR_RETURN(pipeline::FieldSequence sequence, start_sequence(arguments, method, use));
  note_method(method, arguments.input, arguments.codes.model, arguments.passes, record);
  if (!use.colour_filter.empty()) record.resolve("colour-filter", use.colour_filter);
  record.end_step("open");
  std::optional<LiveView> view;
  if (arguments.view) {
    const fs::path name = arguments.output.has_filename() ? arguments.output : arguments.output.parent_path();
    E2LF_ASSIGN_OR_RETURN(LiveView started, LiveView::start(name.filename().string(), output.path(), arguments.port));
    view.emplace(std::move(started));
  }
  CycleWriter writer({.input = arguments.input,
                      .format = arguments.format,
                      .is_quiet = common.quiet,
                      .views = arguments.orientation.after(method.views),
                      .codes = method.codes_of_signs()},
                     std::move(sequence));
  const bool is_strict = arguments.cycles.recording.is_strict;
  E2LF_RETURN_IF_ERROR(process_cycles(input, writer, output, record, arguments, view ? &*view : nullptr, verb));
  warn_of_losses(arguments.input, input.summary());
  verb.note_failed_input(input.summary().live.failure);
  if (!writer.cycles().empty()) warn_of_verdict(writer.cycles().front());
  if (method.lit) say_motion(arguments.input, writer.cycles(), method.lit->model().name);
  if (input.is_recording()) {
    const cycles::CycleReader& reader = input.reader();
    writer.live_log().finish(reader.report());
    if (writer.cycles().empty()) return no_cycle_error(arguments.input, reader.report());
    confidence.warn(arguments.input, reader.report(), reader.schedule());
    record.resolve("source", source_name(reader.source()));
    record.note("found", report_json(reader.report()));
    record.note("read_as", reading_json(reader.recording().info()));
    if (is_live(arguments.input)) record.note("header", header_json(reader.recording().info()));
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
  E2LF_ASSIGN_OR_RETURN(Json about, record.json(verb));
  E2LF_RETURN_IF_ERROR(input.has_one_field() || is_strict ? output.commit(std::move(about))
                                                          : output.update_record(std::move(about)));
  print_result(arguments, common, input, writer.cycles());
  std::fflush(stdout);
  if (!view) return {};
  view->set_folder(arguments.output);
  return view->finish();
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
  add_codes_options(app, reconstruction.codes);
  app.add_option(
         "--method", reconstruction.method,
         "network; inversion (closed form) or regularised (slower, iterative), which need no model, only patterns")
      ->check(CLI::IsMember({"network", "inversion", "regularised"}))
      ->capture_default_str();
  add_camera_option(app, reconstruction.camera,
                    "the camera that recorded the events, for networks conditioned on the sensor profile; default: the "
                    "one that the file of the events states, or else the one for which the model was trained");
  app.add_option(
      "--colour-filter", reconstruction.colour_filter,
      "colours of each 2x2 pixels of the sensor, row by row, such as rggb: the light field has colour and half "
      "the resolution; default: as the record beside the events states");
  app.add_option("--precision", reconstruction.precision, "arithmetic of the network: auto, float32, bfloat16 or int16")
      ->check(CLI::IsMember({"auto", "float32", "bfloat16", "int16"}))
      ->capture_default_str();
  app.add_option("--passes", reconstruction.passes,
                 "number of runs of the network at shifted positions whose results are averaged: better quality, but "
                 "proportionally slower (the paper's network supports only 1)")
      ->check(whole_number(1, 64))
      ->capture_default_str();
  app.add_option("--cycles-per-field", reconstruction.cycles_per_field,
                 "number of cycles of a static scene from which each light field is reconstructed: better with each "
                 "doubling; for networks conditioned on the sensor profile")
      ->check(whole_number(1, 64))
      ->capture_default_str();
  app.add_option("--gain", reconstruction.gain,
                 "brightness of the output: auto (estimated from the first cycle) or a number; 1 = as computed")
      ->capture_default_str();
  app.add_option("--black", reconstruction.black,
                 "brightness that becomes black: a number, or auto (0; with physical pixels and --gain auto, the "
                 "darkest parts of the first cycle)")
      ->capture_default_str();
  app.add_option("--format", reconstruction.format, "png, png16 (64 views) or npy (float32 [8, 8, y, x], not clamped)")
      ->check(CLI::IsMember({"png", "png16", "npy"}))
      ->capture_default_str();
  app.add_flag("--view", reconstruction.view,
               "show each light field in a browser when it is complete, with its latency; ends on Ctrl-C");
  app.add_option("--port", reconstruction.port, "port of 127.0.0.1 for --view; 0 = a free one")->capture_default_str();
  add_cycle_options(app, reconstruction.cycles);
  add_orientation_options(app, reconstruction.orientation);
  verb.stop_gently();
  return verb.run(arguments, [&] { return reconstruct(reconstruction, verb); });
}

}  // namespace e2lf::cli
