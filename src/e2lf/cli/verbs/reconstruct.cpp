// SPDX-License-Identifier: MIT
// e2lf reconstruct: event images or a recording -> light field
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <optional>

#include "e2lf/base/log.h"
#include "e2lf/base/progress.h"
#include "e2lf/base/stop.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/event_images.h"
#include "e2lf/capture/measurement/plausible_events.h"
#include "e2lf/capture/patterns/codes_io.h"
#include "e2lf/capture/patterns/whole_cycle.h"
#include "e2lf/cli/flags/camera_option.h"
#include "e2lf/cli/flags/cycle_input.h"
#include "e2lf/cli/flags/cycle_options.h"
#include "e2lf/cli/flags/inputs.h"
#include "e2lf/cli/flags/network_choice.h"
#include "e2lf/cli/flags/number_check.h"
#include "e2lf/cli/flags/recorded_setup.h"
#include "e2lf/cli/output/light_field_output.h"
#include "e2lf/cli/output/live_log.h"
#include "e2lf/cli/output/next_step.h"
#include "e2lf/cli/output/output.h"
#include "e2lf/cli/output/run_record.h"
#include "e2lf/cli/verb.h"
#include "e2lf/cli/verbs/live_view.h"
#include "e2lf/files/json_text.h"
#include "e2lf/lightfield/orient.h"
#include "e2lf/model/model.h"
#include "e2lf/recon/field_sequence.h"
#include "e2lf/recon/linear_estimate.h"
#include "e2lf/recon/regularised.h"

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

double seconds(CycleClock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

/// A bundled network that was trained for the patterns of the events.
Result<std::optional<model::Model>> find_bundled_network(const ReconstructArguments& arguments,
                                                         const RecordedSetup& setup,
                                                         const std::optional<capture::SensorProfile>& camera,
                                                         RunRecord& record) {
  std::optional<capture::Codes> codes = setup.codes;
  if (!arguments.codes.codes.empty()) {
    E2LF_ASSIGN_OR_RETURN(codes, read_patterns(arguments.codes.codes));
  }
  if (!codes) {
    return Error{ErrorCode::kInvalidValue,
                 "nothing says which patterns the camera showed; give the model that was trained for them with -m",
                 arguments.input.string()};
  }
  E2LF_ASSIGN_OR_RETURN(auto model, bundled_network(*codes, camera, record));
  if (!model) {
    return Error{ErrorCode::kNotFound,
                 "no bundled network was trained for these patterns; give one that was with -m, or use --method "
                 "inversion",
                 arguments.input.string()};
  }
  return model;
}

/// What cycles of a recording must have for the patterns that are named.
Result<CycleFlags> wanted_cycles(const ReconstructArguments& arguments, const std::optional<model::Model>& model) {
  CycleFlags flags = arguments.cycles;
  std::optional<capture::Codes> codes = model ? model->codes : std::nullopt;
  if (model) flags.num_wanted = model->num_patterns;
  if (!arguments.codes.codes.empty()) {
    E2LF_ASSIGN_OR_RETURN(codes, read_patterns(arguments.codes.codes));
    if (!model) flags.num_wanted = codes->num_patterns;
  }
  if (codes && codes->num_patterns >= 2) {
    flags.usual_patterns = capture::codes_of_whole_cycle(*codes).value_or(*codes).num_patterns;
  }
  return flags;
}

/// The network told the camera that it was made for, where --camera names another one. Its light field is made when it
/// is asked for.
std::optional<recon::Rival> rival_of(const ReconstructArguments& arguments, const std::optional<model::Model>& model,
                                     const std::optional<KnownCodes>& known,
                                     const std::optional<capture::SensorProfile>& camera) {
  if (arguments.camera.empty() || arguments.method != "network" || !model || !known || !model->camera ||
      !model->camera->is_pixel() || !model::is_told_the_camera(*model) ||
      capture::to_json(*model->camera) == capture::to_json(*camera)) {
    return std::nullopt;
  }
  auto method = [model = *model](const capture::Measurement& measured,
                                 const ProgressFn&) -> Result<lightfield::LightField> {
    E2LF_ASSIGN_OR_RETURN(const recon::Reconstructor reconstructor, recon::Reconstructor::create(model));
    return reconstructor.reconstruct(measured);
  };
  return recon::Rival{std::move(method), {known->codes, known->constants, {}, model->camera}};
}

/// Takes the camera that the network was made for where nothing names one.
Result<recon::Method> network_method(const ReconstructArguments& arguments, model::Model model,
                                     const std::optional<KnownCodes>& known,
                                     std::optional<capture::SensorProfile>& camera, RunRecord& record) {
  if (!model::is_told_the_camera(model) && !arguments.camera.empty()) {
    return Error{ErrorCode::kInvalidValue, cat(model.name, " works for one camera alone; leave --camera out"),
                 "--camera"};
  }
  tell_patterns(arguments.input, model, known, record);
  tell_camera(camera, model, record);
  if (!camera && model::is_told_the_camera(model)) camera = model.camera;
  E2LF_ASSIGN_OR_RETURN(const engine::Precision precision, engine::precision_from_name(arguments.precision));
  E2LF_ASSIGN_OR_RETURN(recon::Reconstructor reconstructor,
                        recon::Reconstructor::create(std::move(model), {.precision = precision}));
  const size_t passes = reconstructor.num_passes(arguments.passes);
  if (passes < arguments.passes) {
    log_warning(cat("--passes ", arguments.passes, ": the network tells apart ", passes, " position",
                    passes == 1 ? "" : "s", " on its pixel grid, so many passes are made"));
  }
  record.resolve("precision", engine::precision_name(reconstructor.engine().precision()));
  record.note("precision", engine::precision_name(reconstructor.engine().precision()));
  record.note("passes", passes);
  if (arguments.cycles_per_field > 1 && !model::is_told_the_camera(reconstructor.model())) {
    return Error{ErrorCode::kInvalidValue,
                 cat(reconstructor.model().name, " takes one cycle for each light field; leave the option out, or use ",
                     "a model that is told the camera"),
                 "--cycles-per-field"};
  }
  return recon::network_method(std::move(reconstructor), arguments.passes, arguments.cycles_per_field);
}

/// The classical methods know events alone, the bundled networks too.
Result<void> check_measurement(const ReconstructArguments& arguments, capture::MeasurementKind measurement) {
  const bool has_model = arguments.method == "network" && !arguments.codes.model.empty();
  if (measurement == capture::MeasurementKind::kEventImages || has_model) return {};
  return Error{ErrorCode::kInvalidValue,
               cat("this is the measurement ", capture::measurement_name(measurement),
                   "; give a network that was trained for it with -m"),
               arguments.input.string()};
}

/// Those that need patterns alone.
Result<recon::Method> classical_method(const ReconstructArguments& arguments, std::optional<KnownCodes> known,
                                       const std::optional<capture::SensorProfile>& camera, RunRecord& record) {
  if (arguments.passes > 1) {
    return Error{ErrorCode::kInvalidValue,
                 cat("the method ", arguments.method, " makes one pass; leave the option out"), "--passes"};
  }
  if (arguments.cycles_per_field > 1) {
    return Error{ErrorCode::kInvalidValue,
                 cat("the method ", arguments.method, " takes one cycle for each light field; leave the option out"),
                 "--cycles-per-field"};
  }
  if (!known) {
    E2LF_ASSIGN_OR_RETURN(known, load_codes(arguments.codes, record));
    log_warning("nothing confirms that the camera showed these patterns; give the camera's with --codes");
  } else if (!are_patterns_told(known)) {
    warn_of_assumed_patterns(arguments.input, arguments.codes.model.string());
  }
  if (camera && camera->is_pixel()) {
    log_warning(cat("the events are those of physical pixels (", camera->name, "); the method ", arguments.method,
                    " knows the paper's event model alone"));
  }
  if (arguments.method == "regularised") {
    return recon::Method([known = std::move(*known)](const capture::Measurement& measured, const ProgressFn& progress) {
      return recon::reconstruct_regularised(measured.events, known.codes, known.constants, {}, progress);
    });
  }
  return recon::Method([known = std::move(*known)](const capture::Measurement& measured, const ProgressFn&) {
    return recon::reconstruct_by_inversion(measured.events, known.codes, known.constants);
  });
}

std::string cycle_name(size_t cycle) {
  std::string number = std::to_string(cycle);
  number.insert(0, number.size() < 5 ? 5 - number.size() : 0, '0');
  return "cycle_" + number;
}

Error at(Error error, const fs::path& input) {
  error.location = input.string();
  return error;
}

/// What the result of each cycle is checked against; nothing where nobody told the patterns.
Result<std::optional<recon::EventCheck>> event_check(const std::optional<KnownCodes>& known,
                                                     const std::optional<capture::SensorProfile>& camera) {
  if (!known) return std::optional<recon::EventCheck>();
  E2LF_ASSIGN_OR_RETURN(const auto model, sensor::event_model_from_name(known->event_model));
  recon::EventCheck check{known->codes, known->constants, model};
  if (camera && camera->is_pixel()) check.pixels = camera;
  return std::optional(std::move(check));
}

/// Chooses how the check is judged. A method that does not know the camera leaves an error that says nothing about the
/// polarity or the order of the events. If the camera of the events is unknown, a network is judged by its own.
/// `is_told`: the method is a network that is told the camera.
recon::Judging judging_of(const ReconstructArguments& arguments, bool is_told,
                          const std::optional<capture::SensorProfile>& camera) {
  if (!camera) return arguments.method == "network" ? recon::Judging::kNoise : recon::Judging::kNone;
  if (camera->is_pixel() && !is_told) return recon::Judging::kNone;
  return arguments.method == "regularised" ? recon::Judging::kNoise : recon::Judging::kChanges;
}

/// Black is looked for where physical pixels leave it open and brightness is not to be measured.
Result<recon::Tone> tone_of(const ReconstructArguments& arguments,
                            const std::optional<capture::SensorProfile>& camera) {
  recon::Tone tone;
  E2LF_ASSIGN_OR_RETURN(tone.gain, parse_gain(arguments.gain));
  E2LF_ASSIGN_OR_RETURN(tone.black, parse_black(arguments.black));
  if (!tone.black && (tone.gain || !camera || !camera->is_pixel())) tone.black = 0.0F;
  return tone;
}

Json check_json(const recon::EventJudgement& judgement) {
  Json json = {{"verdict", recon::verdict_name(judgement.verdict)},
               {"error", judgement.error},
               {"noise_error", judgement.noise_error},
               {"ratio", judgement.ratio}};
  if (!judgement.change.empty()) {
    json["changed"] = {
        {"how", judgement.change}, {"error", judgement.changed_error}, {"unchanged_error", judgement.unchanged_error}};
  }
  if (judgement.rival_error) json["error_with_the_models_camera"] = *judgement.rival_error;
  return json;
}

/// Reconstructs cycles and writes each; what has been done so far.
class CycleWriter {
 public:
  CycleWriter(const ReconstructArguments& arguments, const CommonOptions& common,
              std::optional<capture::Orientation> views, std::optional<capture::Codes> codes,
              recon::FieldSequence sequence)
      : arguments_(arguments),
        common_(common),
        views_(views),
        codes_(std::move(codes)),
        sequence_(std::move(sequence)) {}

  /// Into an existing folder. Returns the light field, upright.
  Result<LightField> process(const CycleImages& cycle, const fs::path& folder) {
    E2LF_ASSIGN_OR_RETURN(recon::Field field, reconstruct(cycle));
    E2LF_RETURN_IF_ERROR(write_reconstruction(folder, field.light_field, arguments_.format, views(), {}));
    Json about = cycle.about;
    about["cycle"] = cycles_.size();
    about["gain"] = field.gain;
    about["black"] = field.black;
    about["reconstruct_s"] = field.reconstruct_s;
    about["latency_s"] = cycle.behind_s + seconds(CycleClock::now() - cycle.ready);
    if (field.error) {
      about["event_error"] = field.error->at_first;
      about["least_event_error"] = {{"value", field.error->least}, {"residue", field.error->residue}};
    }
    if (field.judgement) about["check"] = check_json(*field.judgement);
    if (cycle.is_live) live_log_.add(about["number"], about["events"], about["latency_s"]);
    cycles_.push_back(std::move(about));
    return std::move(field.light_field);
  }

  /// What the records of folders with views note of them.
  [[nodiscard]] Json notes() const {
    if (!views_) return Json::object();
    return {{"views", lightfield::views_note(*views_, stored_views(arguments_.format, *views_))}};
  }

  [[nodiscard]] const Json& cycles() const { return cycles_; }
  [[nodiscard]] const LiveLog& live_log() const { return live_log_; }
  /// Of all cycles; there must be one.
  [[nodiscard]] const recon::Tone& tone() const { return sequence_.tone(); }

 private:
  [[nodiscard]] capture::Orientation views() const { return views_.value_or(capture::Orientation{}); }

  Result<recon::Field> reconstruct(const CycleImages& cycle) {
    // Of live input the log tells, a line for each cycle.
    ProgressBar bar(cat("reconstruct ", cycle_name(cycles_.size())), common_.quiet || cycle.is_live);
    bar.update(0, 1);
    warn_of_events(cycle);
    auto field = sequence_.next(cycle.images, bar.callback());
    if (!field && field.error().location.empty()) return at(field.error(), arguments_.input);
    return field;
  }

  /// Says of the first cycles why their events are hardly those of a scene.
  void warn_of_events(const CycleImages& cycle) {
    constexpr size_t kMostWarnings = 3;
    if (warned_ == kMostWarnings || !capture::has_events(cycle.images.kind)) return;
    const std::vector<std::string> doubts = capture::event_doubts(cycle.images.events, codes_ ? &*codes_ : nullptr);
    for (const std::string& doubt : doubts) {
      log_warning(cat(arguments_.input.string(), ", cycle ", cycles_.size(), ": ", doubt));
    }
    warned_ += doubts.empty() ? 0 : 1;
    if (warned_ == kMostWarnings && !doubts.empty()) log_warning("of further cycles nothing of that kind is said");
  }

  const ReconstructArguments& arguments_;
  const CommonOptions& common_;
  size_t warned_ = 0;
  std::optional<capture::Orientation> views_;
  std::optional<capture::Codes> codes_;  ///< that were shown, where that is known
  recon::FieldSequence sequence_;
  Json cycles_ = Json::array();
  LiveLog live_log_;
};

/// What is shown beside a cycle: how long it took, from its last event where it came live.
std::string note_of(const Json& cycle, bool is_live) {
  char text[80];
  std::snprintf(text, sizeof text, is_live ? "latency %.3f s" : "reconstructed in %.3f s",
                cycle[is_live ? "latency_s" : "reconstruct_s"].get<double>());
  return text;
}

/// One cycle goes into the folder itself. Of several, the folder of each appears, whole, as soon as it is done, since
/// earlier cycles are of use while later ones are still being made. The folder of all appears with the first, so that
/// an input without any replaces nothing; with --strict at the end, since only then nothing was left out.
Result<void> process_cycles(CycleInput& input, CycleWriter& writer, ResultFolder& output, const RunRecord& record,
                            const ReconstructArguments& arguments, LiveView* view, const Verb& verb) {
  const bool is_strict = arguments.cycles.recording.is_strict;
  while (writer.cycles().empty() || !stop_requested()) {
    E2LF_ASSIGN_OR_RETURN(const std::optional<CycleImages> images, input.next());
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
    // Who sees a cycle in the browser finds its files.
    if (view != nullptr) view->add(name, std::move(light_field), note_of(cycle, images->is_live));
    if (view != nullptr && appears) view->set_folder(arguments.output);
    if (is_all) return {};
  }
  return {};
}

Json constants_json(const KnownCodes& known) {
  return {{"eps", json_number(known.constants.eps)},
          {"tau", json_number(known.constants.tau)},
          {"sigma_w", json_number(known.constants.sigma_w)},
          {"sigma_z", json_number(known.constants.sigma_z)},
          {"event_model", known.event_model}};
}

void print_event_error(const Json& cycle) {
  std::printf(
      "simulated again with these patterns and this camera, it differs from the events by %.3f per pixel and "
      "transition",
      cycle["event_error"].get<double>());
  const Json& least = cycle["least_event_error"];
  const double residue = least["residue"].get<double>();
  if (residue > 0) {
    std::printf(", by %.3f if references start %.2f thresholds above the first intensity", least["value"].get<double>(),
                residue);
  }
  if (!cycle.contains("check")) {
    std::printf("\n");
    return;
  }
  const Json& check = cycle["check"];
  std::printf("; %.1f times what noise makes: %s\n", check["ratio"].get<double>(),
              check["verdict"] == "good"    ? "good"
              : check["verdict"] == "usual" ? "as usual"
                                            : "see the warning");
}

void warn_of_verdict(const Json& cycle) {
  if (!cycle.contains("check")) return;
  const Json& check = cycle["check"];
  if (check["verdict"] == "wrong") {
    std::array<char, 16> ratio;
    std::snprintf(ratio.data(), ratio.size(), "%.1f", check["ratio"].get<double>());
    log_warning(cat("the light field differs from its events by ", ratio.data(),
                    " times what noise makes: the polarity of the events, the order of the patterns or the camera is "
                    "likely wrong; check them (`e2lf codes show`, docs/recordings.md)"));
  } else if (check["verdict"] == "changed-better") {
    const Json& changed = check["changed"];
    std::array<char, 64> errors;
    std::snprintf(errors.data(), errors.size(), "%.3f in place of %.3f", changed["error"].get<double>(),
                  changed["unchanged_error"].get<double>());
    const std::string how = changed["how"].get<std::string>();
    log_warning(cat("the events are explained much better ", how, ": a light field of them differs by ", errors.data(),
                    how.find("polarity") != std::string::npos
                        ? "; give --invert-polarity"
                        : "; check the order of the patterns (--codes, --first-pattern)"));
  } else if (check["verdict"] == "rival-better") {
    std::array<char, 64> errors;
    std::snprintf(errors.data(), errors.size(), "%.3f in place of %.3f", check["error"].get<double>(),
                  check["error_with_the_models_camera"].get<double>());
    log_warning(
        cat("the camera of --camera explains the events much worse than the one that the network was made for: ",
            "they differ by ", errors.data(), "; leave --camera out, or calibrate again"));
  }
}

/// Where the views are: each cycle of a recording, and of several, has a folder of its own.
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

void print_result(const ReconstructArguments& arguments, const CommonOptions& common, const CycleInput& input,
                  const Json& cycles) {
  if (common.json) {
    const Json result = {
        {"output", arguments.output.string()}, {"cycles", cycles}, {"left_out", losses_json(input.summary())}};
    std::printf("%s", json_text(result).c_str());
  } else if (!common.quiet) {
    const std::string where = place_of_views(arguments.output, input.has_one_field(), cycles.size());
    std::printf("%zu light field%s in %s (black %.3g, gain %.3g): views, contact_sheet.png, epi.png, run.json\n",
                cycles.size(), cycles.size() == 1 ? "" : "s", where.c_str(), cycles.front()["black"].get<double>(),
                cycles.front()["gain"].get<double>());
    if (cycles.front().contains("event_error")) print_event_error(cycles.front());
    if (!arguments.view) print_next_step(next_step(arguments, input.has_one_field()), common);
  }
}

Result<void> reconstruct(const ReconstructArguments& arguments, const Verb& verb) {
  if (arguments.port != 0 && !arguments.view) {
    return Error{ErrorCode::kInvalidValue, "a port is for --view alone; leave it out, or add --view", "--port"};
  }
  const CommonOptions& common = verb.common();
  const OutputRules rules{.inputs = {arguments.input, arguments.codes.model, arguments.codes.codes,
                                     arguments.cycles.schedule, arguments.camera},
                          .overwrite = common.overwrite};
  E2LF_ASSIGN_OR_RETURN(ResultFolder output, open_output_folder(arguments.output, rules));
  RunRecord record("reconstruct");
  E2LF_ASSIGN_OR_RETURN(std::optional<model::Model> model, read_named_model(arguments.codes, record));
  E2LF_ASSIGN_OR_RETURN(const CycleFlags cycles, wanted_cycles(arguments, model));
  E2LF_ASSIGN_OR_RETURN(CycleInput input, open_cycle_input(arguments.input, cycles, arguments.cycles_per_field, verb));
  if (input.is_without_events()) {
    return Error{
        ErrorCode::kInvalidValue,
        "there are no events: all counts are 0, so there is nothing to reconstruct; check what they were made of",
        arguments.input.string()};
  }
  E2LF_RETURN_IF_ERROR(check_measurement(arguments, input.measurement()));
  E2LF_ASSIGN_OR_RETURN(const RecordedSetup setup, input.setup(arguments.input));
  E2LF_ASSIGN_OR_RETURN(std::optional<capture::SensorProfile> camera,
                        camera_of_events(arguments.camera, setup, record));
  const bool is_camera_named = !arguments.camera.empty() && camera->views;
  const auto views = arguments.orientation.after(is_camera_named ? camera->views : setup.views);
  if (!model && arguments.method == "network") {
    E2LF_ASSIGN_OR_RETURN(model, find_bundled_network(arguments, setup, camera, record));
  }
  E2LF_ASSIGN_OR_RETURN(std::optional<KnownCodes> codes, find_codes(arguments.codes, model, setup.codes, record));
  const std::string filter =
      arguments.colour_filter.empty() ? recorded_colour_filter(arguments.input) : arguments.colour_filter;
  std::optional<recon::Rival> rival = rival_of(arguments, model, codes, camera);
  const bool is_told = arguments.method == "network" && model::is_told_the_camera(*model);
  E2LF_ASSIGN_OR_RETURN(recon::Method method, arguments.method == "network"
                                                  ? network_method(arguments, std::move(*model), codes, camera, record)
                                                  : classical_method(arguments, codes, camera, record));
  if (!filter.empty()) {
    E2LF_ASSIGN_OR_RETURN(const capture::ColourFilter colours, capture::colour_filter_from_name(filter));
    method = recon::colour_method(std::move(method), colours);
    record.resolve("colour-filter", filter);
  }
  record.end_step("open");
  // Slow pixels still follow the change to black when the first pattern is lit: in dim light most of their first events
  // are OFF, so that only the signs of the paper's event model are known.
  const bool are_signs_known = codes && camera && !camera->is_pixel();
  const auto signs_of = are_signs_known ? std::optional(codes->codes) : std::nullopt;
  const std::optional<Json> known_constants = codes ? std::optional(constants_json(*codes)) : std::nullopt;
  // Patterns that are only assumed say nothing of how well the result explains its events: wrong ones explain them too.
  // Nor do those of one cycle of the counts of several. Of colours the check knows nothing.
  if (!are_patterns_told(codes) || arguments.cycles_per_field > 1 || !filter.empty()) codes.reset();
  if (known_constants) record.note("constants", *known_constants);
  E2LF_ASSIGN_OR_RETURN(const recon::Tone tone, tone_of(arguments, camera));
  E2LF_ASSIGN_OR_RETURN(auto check, event_check(codes, camera));
  std::optional<LiveView> view;
  if (arguments.view) {
    const fs::path name = arguments.output.has_filename() ? arguments.output : arguments.output.parent_path();
    E2LF_ASSIGN_OR_RETURN(LiveView started, LiveView::start(name.filename().string(), output.path(), arguments.port));
    view.emplace(std::move(started));
  }
  const recon::Judging judging = judging_of(arguments, is_told, camera);
  CycleWriter writer(arguments, common, views, signs_of,
                     {std::move(method), tone, std::move(check), std::move(rival), judging});
  const bool is_strict = arguments.cycles.recording.is_strict;
  E2LF_RETURN_IF_ERROR(process_cycles(input, writer, output, record, arguments, view ? &*view : nullptr, verb));
  warn_of_losses(arguments.input, input.summary());
  verb.note_failed_input(input.summary().live.failure);
  if (!writer.cycles().empty()) warn_of_verdict(writer.cycles().front());
  if (input.is_recording()) {
    writer.live_log().finish(input.report());
    if (writer.cycles().empty()) return no_cycle_error(arguments.input, input.report());
    input.confidence().warn(arguments.input, input.report(), input.schedule());
    record.resolve("source", source_name(input.source()));
    record.note("found", report_json(input.report()));
    record.note("read_as", reading_json(input.info()));
    if (is_live(arguments.input)) record.note("header", header_json(input.info()));
  }
  record.note("left_out", losses_json(input.summary()));
  record.note("live", live_json(input.summary()));
  const Json notes = writer.notes();
  for (const auto& [key, note] : notes.items()) record.note(key, note);
  record.end_step("reconstruct");
  // Where no cycle has events, neither is found.
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
                 "event images (.npz, .npy, folder of event_image_00000.npy ...), a recording, - for a pipe, "
                 "tcp://127.0.0.1:PORT, camera://NAME, replay:FILE (a recording at its own speed)")
      ->required();
  app.add_option("-o,--output", reconstruction.output, "folder to write")->required();
  add_codes_options(app, reconstruction.codes);
  app.add_option(
         "--method", reconstruction.method,
         "network; inversion (closed form) or regularised (slower, iterative), which need no model, only patterns")
      ->check(CLI::IsMember({"network", "inversion", "regularised"}))
      ->capture_default_str();
  add_camera_option(app, reconstruction.camera,
                    "the camera that recorded, for networks that are told; default: the one that the events' file "
                    "names, else the one "
                    "that the model was made for");
  app.add_option(
      "--colour-filter", reconstruction.colour_filter,
      "colours of each 2x2 pixels of the sensor, row by row, such as rggb: the light field has colour and half "
      "the size; default: as the record beside the events says");
  app.add_option("--precision", reconstruction.precision, "arithmetic of the network: auto, float32 or bfloat16")
      ->check(CLI::IsMember({"auto", "float32", "bfloat16"}))
      ->capture_default_str();
  app.add_option("--passes", reconstruction.passes,
                 "run the network so many times, each time with the picture shifted, and average: finer, and as many "
                 "times slower (at most 64; the paper's network: 1)")
      ->check(whole_number(1, 64))
      ->capture_default_str();
  app.add_option("--cycles-per-field", reconstruction.cycles_per_field,
                 "make each light field of so many cycles of a scene that stands still: better with each doubling; for "
                 "networks that are told the camera")
      ->check(whole_number(1, 64))
      ->capture_default_str();
  app.add_option("--gain", reconstruction.gain,
                 "brightness of the output: auto (estimated on the first cycle) or a number; 1 = as computed")
      ->capture_default_str();
  app.add_option("--black", reconstruction.black,
                 "brightness that becomes black: a number, or auto (0; with physical pixels and --gain auto the "
                 "darkest parts of the first cycle)")
      ->capture_default_str();
  app.add_option("--format", reconstruction.format, "png, png16 (64 views) or npy (float32 [8, 8, y, x], not clamped)")
      ->check(CLI::IsMember({"png", "png16", "npy"}))
      ->capture_default_str();
  app.add_flag("--view", reconstruction.view,
               "show each light field in a browser as it comes, with its latency; goes on until Ctrl-C");
  app.add_option("--port", reconstruction.port, "of 127.0.0.1, for --view; 0 = a free one")->capture_default_str();
  add_cycle_options(app, reconstruction.cycles);
  add_orientation_options(app, reconstruction.orientation);
  verb.stop_gently();
  return verb.run(arguments, [&] { return reconstruct(reconstruction, verb); });
}

}  // namespace e2lf::cli
