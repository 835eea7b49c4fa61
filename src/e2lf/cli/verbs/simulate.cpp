// SPDX-License-Identifier: MIT
// e2lf simulate: simulates event images or a recording of a light field
#include <functional>
#include <memory>
#include <optional>
#include <tuple>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/event_image_io.h"
#include "e2lf/cli/flags/stream_flags.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/cycles/synthesise.h"
#include "e2lf/eval/metrics.h"
#include "e2lf/eval/report.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/options.h"
#include "e2lf/pipeline/recorded_setup.h"
#include "e2lf/pipeline/simulated_cycles.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/options.h"
#include "e2lf/program/outputs.h"
#include "e2lf/recordings/open/registry.h"
#include "e2lf/sensor/event_model.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

struct SimulateArguments {
  fs::path input, output;
  CodesSource codes;
  std::string event_model, camera, measurement;
  std::optional<float> eps, tau, sigma_w, sigma_z, sigma_i;
  float scene_gain = 1.0F, residue = 0.0F;
  size_t cycles = 1;
  bool no_triggers = false;
  LightFieldFlags light_field;
  StreamFlags stream;
};

/// Prints the number and size of the intensity images and the statistics of the events, as far as there are any.
void print_measurement(const capture::Measurement& measured, const CommonOptions& common) {
  const capture::CodedIntensities& images = measured.images;
  const capture::EventImages& events = measured.events;
  const char* const kind = capture::measurement_name(measured.kind);
  std::string text;
  const bool has_images = images.count > 0;
  Json json = {{"measurement", kind},
               {"images", images.count},
               {"height", has_images ? images.height : events.height},
               {"width", has_images ? images.width : events.width}};
  if (has_images) {
    text = cat(kind, ": ", counted(images.count, "intensity image"), " of ", images.width, "x", images.height, " px\n");
  }
  if (events.count > 0) {
    const eval::EventStatistics statistics = eval::event_statistics(events);
    json.update(eval::to_json(statistics));
    text += formatted(
        "%zu transitions of %zux%zu px, %.2f events per pixel; a sensor of 1.066 G events/s needs at least %.1f ms\n",
        events.count, events.width, events.height, statistics.total_events_per_pixel, statistics.min_measurement_ms);
  }
  print_result(common, json, text);
}

/// Fails if constants of the paper's model are given for physical pixels.
Result<void> check_model_flags(const SimulateArguments& arguments, const capture::SensorProfile& camera) {
  const bool has_flags = arguments.eps || arguments.tau || arguments.sigma_w || arguments.sigma_z ||
                         arguments.residue != 0.0F || !arguments.event_model.empty();
  if (!camera.is_pixel() || !has_flags) return {};
  return fail(ErrorCode::kInvalidValue, "--camera " + arguments.camera,
              "--event-model, --eps, --tau, --sigma-w, --sigma-z and --residue belong to the paper's model; leave ",
              "them out, or change the constants in a camera file of your own");
}

Result<OutputFile> open_events(const SimulateArguments& arguments, const Verb& verb) {
  if (arguments.output.extension() == ".npz") return open_output(arguments.output, verb);
  E2LF_ASSIGN_OR_RETURN(const recordings::Codec* codec, recordings::codec_to_write(arguments.output, ""));
  return OutputFile::create(arguments.output, recording_output_rules(verb, *codec));
}

/// Patterns, camera, event model and constants, and how the scene is read.
struct Setup {
  pipeline::KnownCodes known;
  std::optional<capture::SensorProfile> camera;
  std::optional<cycles::Schedule> schedule;  ///< absent = the paper's
  SceneOptions scene;                        ///< one view for each cell of the patterns, oriented as the camera sees it
  capture::RecordedSetup recorded;           ///< what is stored in the result
  bool as_images = true;                     ///< the output holds measurements, and is not a recording
  [[nodiscard]] bool is_pixel() const { return camera && camera->is_pixel(); }
  [[nodiscard]] bool has_images() const { return known.measurement != capture::MeasurementKind::kEventImages; }
};

/// Reads patterns and camera. Flags take precedence over the camera, the camera over the model, and the model over the
/// paper.
Result<Setup> read_setup(const SimulateArguments& arguments, RunRecord& record) {
  Setup setup;
  setup.as_images = arguments.output.extension() == ".npz";
  if (!arguments.stream.schedule.empty()) {
    record.add_input(arguments.stream.schedule);
    E2LF_ASSIGN_OR_RETURN(setup.schedule, cycles::read_schedule(arguments.stream.schedule));
  }
  const bool are_codes_named = !arguments.codes.codes.empty() || !arguments.codes.model.empty();
  if (setup.schedule && setup.schedule->codes && !are_codes_named) {
    setup.known.codes = *setup.schedule->codes;
  } else {
    E2LF_ASSIGN_OR_RETURN(setup.known, load_codes(arguments.codes, record));
  }
  const capture::Codes& codes = setup.known.codes;
  std::string& event_model = setup.known.event_model;
  capture::SensorConstants& constants = setup.known.constants;
  std::optional<capture::Orientation> views;
  if (!arguments.camera.empty()) {
    E2LF_ASSIGN_OR_RETURN(setup.camera, load_camera(arguments.camera, record));
    E2LF_RETURN_IF_ERROR(check_model_flags(arguments, *setup.camera));
    constants = setup.camera->constants;
    if (!setup.is_pixel()) event_model = setup.camera->event_model;
    views = setup.camera->views;
  }
  if (setup.schedule) {
    if (!views) views = setup.schedule->views;
    if (capture::codes_of_whole_cycle(codes)) setup.schedule = with_all_transitions(*setup.schedule);
  }
  setup.scene = {arguments.light_field, codes.views_y, codes.views_x};
  if (views) setup.scene.flags.orientation = {false, views->flip_x, views->flip_y};
  if (!arguments.event_model.empty()) event_model = arguments.event_model;
  if (!arguments.measurement.empty()) {
    E2LF_ASSIGN_OR_RETURN(setup.known.measurement,
                          choice_of(arguments.measurement, capture::kMeasurementKinds, "measurement"));
  }
  record.resolve("measurement", capture::measurement_name(setup.known.measurement));
  constants = {.eps = arguments.eps.value_or(constants.eps),
               .tau = arguments.tau.value_or(constants.tau),
               .sigma_w = arguments.sigma_w.value_or(constants.sigma_w),
               .sigma_z = arguments.sigma_z.value_or(constants.sigma_z),
               .sigma_i = arguments.sigma_i.value_or(constants.sigma_i)};
  setup.recorded = {codes, setup.camera, views};
  if (setup.is_pixel()) return setup;
  // Camera files do not support ESIM and v2e.
  setup.recorded.camera.reset();
  if (sensor::event_model_from_name(event_model)) {
    setup.recorded.camera = setup.camera.value_or(capture::SensorProfile{});
    setup.recorded.camera->event_model = event_model;
    setup.recorded.camera->constants = constants;
  }
  record.resolve("event-model", event_model);
  record.resolve("eps", json_number(constants.eps));
  record.resolve("tau", json_number(constants.tau));
  record.resolve("sigma-w", json_number(constants.sigma_w));
  record.resolve("sigma-z", json_number(constants.sigma_z));
  return setup;
}

/// Returns true if events must be simulated one by one. Recordings of the paper's models are otherwise generated from
/// counts per pattern.
bool is_stream(const SimulateArguments& arguments, const Setup& setup) {
  if (need_stream(arguments.stream) || (setup.is_pixel() && !setup.as_images)) return true;
  const std::string& model = setup.known.event_model;
  return !sensor::event_model_from_name(model) && streams::stream_model_from_name(model);
}

struct SimulatedCycle {
  capture::Measurement measured;  ///< of a recording, only that of the first cycle is needed
  recordings::EventBatch batch;   ///< for recordings: its events and triggers
  uint64_t lost_events = 0;       ///< lost to the readout in all cycles so far
};
using NextCycle = std::function<Result<SimulatedCycle>(uint64_t cycle)>;

/// Ends the events before the last `patterns` patterns of a cycle.
void leave_out_last(size_t patterns, cycles::SynthesisedCycle& cycle) {
  if (patterns == 0) return;
  const int64_t end_us = cycle.starts_us[cycle.starts_us.size() - patterns];
  recordings::EventColumns& events = cycle.batch.events;
  events.resize(static_cast<size_t>(std::ranges::lower_bound(events.t, end_us) - events.t.begin()));
  std::erase_if(cycle.batch.triggers, [end_us](const auto& trigger) { return trigger.t >= end_us; });
}

/// Simulates the counts of each pattern; in a recording, the events are distributed over its duration.
Result<NextCycle> counted_cycles(const SimulateArguments& arguments, const Setup& setup, const StreamScene& scene,
                                 uint64_t seed) {
  E2LF_ASSIGN_OR_RETURN(lightfield::LightField field, scene.scene.at(0));
  pipeline::SimulatedCamera camera{.measurement = setup.known.measurement,
                                   .codes = setup.known.codes,
                                   .profile = setup.camera.value_or(capture::SensorProfile{}),
                                   .gain = arguments.scene_gain,
                                   .residue = arguments.residue,
                                   .seed = seed};
  camera.profile.constants = setup.known.constants;
  if (!setup.is_pixel()) camera.profile.event_model = setup.known.event_model;
  if (setup.as_images) {
    return NextCycle([=, field = std::move(field)](uint64_t cycle) -> Result<SimulatedCycle> {
      SimulatedCycle simulated;
      E2LF_ASSIGN_OR_RETURN(simulated.measured, pipeline::simulate_cycle(camera, field, cycle));
      return simulated;
    });
  }
  // The display shows the whole cycle, whichever transitions the network takes, and ends with the lit patterns if it
  // takes those.
  const size_t transitions = camera.codes.num_patterns - 1;
  if (!capture::codes_of_whole_cycle(camera.codes)) camera.codes = capture::whole_cycle(camera.codes);
  cycles::SynthesisOptions synthesis{.schedule = cycles::paper_schedule_of(camera.codes)};
  if (arguments.no_triggers) synthesis.trigger_channel.reset();
  return NextCycle(
      [=, field = std::move(field), num_cycles = arguments.cycles](uint64_t cycle) -> Result<SimulatedCycle> {
        SimulatedCycle simulated;
        E2LF_ASSIGN_OR_RETURN(simulated.measured, pipeline::simulate_cycle(camera, field, cycle));
        capture::EventImages& events = simulated.measured.events;
        cycles::SynthesisedCycle synthesised = cycles::synthesise_cycle(events, cycle, synthesis);
        if (cycle + 1 == num_cycles) leave_out_last(events.count - transitions, synthesised);
        simulated.batch = std::move(synthesised.batch);
        events.count = transitions;
        events.values.resize(transitions * events.image_size());
        return simulated;
      });
}

Result<NextCycle> played_cycles(const SimulateArguments& arguments, const Setup& setup,
                                const streams::StreamOptions& stream, StreamScene& scene) {
  const capture::Codes& codes = setup.known.codes;
  streams::RigOptions options{.schedule = setup.schedule ? *setup.schedule : cycles::paper_schedule_of(codes),
                              .gain = arguments.scene_gain,
                              .rise_us = arguments.stream.rise_us};
  if (arguments.no_triggers) options.trigger_channel.reset();
  E2LF_ASSIGN_OR_RETURN(streams::VirtualRig rig,
                        streams::VirtualRig::create(codes, setup.camera.value_or(capture::SensorProfile{}), stream,
                                                    options, std::move(scene.scene), scene.height, scene.width));
  const auto shared = std::make_shared<streams::VirtualRig>(std::move(rig));
  return NextCycle([shared, as_images = setup.as_images](uint64_t cycle) -> Result<SimulatedCycle> {
    SimulatedCycle simulated;
    E2LF_ASSIGN_OR_RETURN(simulated.batch, shared->play_cycle());
    if (as_images || cycle == 0) simulated.measured = shared->sum_windows(simulated.batch);
    simulated.lost_events = shared->lost_events();
    return simulated;
  });
}

/// The file that a simulation writes cycle by cycle: a recording, event images, or measurements with intensity images.
class SimulatedFile {
 public:
  /// Creates the file, with the setup in it. Warns if its format cannot hold the triggers.
  static Result<SimulatedFile> create(const fs::path& place, const SimulateArguments& arguments, const Setup& setup,
                                      const StreamScene& scene) {
    SimulatedFile file;
    if (setup.has_images()) {
      file.measurements_path_ = place;
      file.measurements_.setup = setup.recorded;
    } else if (setup.as_images) {
      E2LF_ASSIGN_OR_RETURN(file.images_, capture::EventImageWriter::create(place));
      file.images_->keep(setup.recorded);
    } else {
      recordings::RecordingInfo info;
      info.height = scene.height;
      info.width = scene.width;
      info.header = capture::setup_to_header(setup.recorded);
      E2LF_ASSIGN_OR_RETURN(file.recording_, recordings::create_recording(place, "", info));
      if (!arguments.no_triggers && !file.recording_->holds_triggers()) {
        log_warning(cat(arguments.output.string(), ": this format cannot hold triggers, so they are left out; write ",
                        ".raw, .hdf5 or .dat for them"));
      }
    }
    return file;
  }

  Result<void> add(SimulatedCycle cycle) {
    if (recording_) return recording_->write(cycle.batch);
    if (images_) return images_->add(cycle.measured.events);
    measurements_.cycles.push_back(std::move(cycle.measured));
    return {};
  }

  Result<void> finish() {
    if (recording_) return recording_->finish();
    return images_ ? images_->finish() : capture::write_measurements(measurements_path_, measurements_);
  }

 private:
  std::unique_ptr<recordings::RecordingWriter> recording_;
  std::unique_ptr<capture::EventImageWriter> images_;
  capture::MeasurementFile measurements_;
  fs::path measurements_path_;
};

/// Fails if a constant is given that the event model, or a measurement without events, does not have.
Result<void> check_constants(const SimulateArguments& arguments, const Setup& setup) {
  const std::string& model = setup.known.event_model;
  const bool has_events = capture::has_events(setup.known.measurement), is_v2e = model == "v2e";
  const std::tuple<const char*, bool, bool> flags[] = {
      {"--event-model", !arguments.event_model.empty(), has_events},
      {"--eps", arguments.eps.has_value(), has_events && !is_v2e},
      {"--tau", arguments.tau.has_value(), has_events && !is_v2e},
      {"--sigma-w", arguments.sigma_w.has_value(), has_events && !is_v2e && model != "esim"},
      {"--sigma-z", arguments.sigma_z.has_value(), has_events && !is_v2e},
      {"--residue", arguments.residue != 0.0F, has_events}};
  for (const auto& [flag, is_given, is_used] : flags) {
    if (!is_given || is_used) continue;
    return fail(ErrorCode::kInvalidValue, flag, "has no effect on ",
                has_events ? cat("the event model ", model) : "a measurement without events", "; omit it");
  }
  return {};
}

Result<void> check_use(const SimulateArguments& arguments, const Setup& setup, bool is_stream, const Verb& verb) {
  E2LF_RETURN_IF_ERROR(check_constants(arguments, setup));
  const auto useless = [](const char* flag, const char* why) {
    return fail(ErrorCode::kInvalidValue, flag, why, "; leave it out");
  };
  if (setup.has_images() && (!setup.as_images || is_stream)) {
    return fail(ErrorCode::kInvalidValue, arguments.output, "the measurement ",
                capture::measurement_name(setup.known.measurement),
                " is not a stream of events; write an .npz, without options of streams");
  }
  if (!setup.has_images() && arguments.sigma_i) {
    return useless("--sigma-i", "event images have no noise of intensity images");
  }
  if (setup.as_images && arguments.no_triggers) {
    return useless("--no-triggers", "event images do not contain triggers");
  }
  if (!is_stream) {
    E2LF_RETURN_IF_ERROR(verb.refuse_options({kStreamOptions}, "counts of whole patterns"));
    E2LF_RETURN_IF_ERROR(sensor::event_model_from_name(setup.known.event_model));
    return {};
  }
  const StreamFlags defaults;
  const bool is_v2e = !setup.is_pixel() && setup.known.event_model == "v2e";
  if (arguments.stream.v2e_preset != defaults.v2e_preset && !is_v2e) {
    return useless("--v2e-preset", "the events are not those of the model v2e");
  }
  const bool has_size = arguments.stream.width != defaults.width || arguments.stream.height != defaults.height;
  if (has_size && !arguments.stream.has_turntable()) {
    return useless("--width, --height", "the size is that of the input");
  }
  if (arguments.residue == 0.0F) return {};
  return useless("--residue", "event by event, references follow from earlier events");
}

/// Returns the flags with which these events can be reconstructed. Networks for their patterns are found automatically.
std::string network_flags(const SimulateArguments& arguments, const Setup& setup) {
  const fs::path& model = arguments.codes.model;
  if (!model.empty() && model == bundled_model()) return "";
  if (!model.empty()) return " -m " + shell_word(fs::path(shown_name(kBundledModels, model)));
  if (setup.has_images()) return " -m MODEL";
  return capture::is_black_first(setup.known.codes) ? "" : " --method inversion";  // networks for any patterns need it
}

std::string next_step(const SimulateArguments& arguments, const Setup& setup) {
  const std::string events = shell_word(arguments.output);
  fs::path result = arguments.output;
  if (!setup.as_images) {
    const fs::path& schedule = arguments.stream.schedule;
    return cat(
        "e2lf accumulate ", events, " -o ", shell_word(result.replace_extension(".npz")),
        schedule.empty() ? "" : cat(" --schedule ", shell_word(schedule)),
        arguments.no_triggers ? cat(" --source schedule --origin-us ", cycles::SynthesisOptions().begin_us) : "");
  }
  result.replace_extension() += "-lightfield";
  return cat("e2lf reconstruct ", events, network_flags(arguments, setup), " -o ", shell_word(result));
}

Result<void> simulate(const SimulateArguments& arguments, const Verb& verb) {
  const CommonOptions& common = verb.common();
  E2LF_ASSIGN_OR_RETURN(OutputFile output, open_events(arguments, verb));
  RunRecord record(verb);
  if (!arguments.input.empty()) record.add_input(arguments.input);
  E2LF_ASSIGN_OR_RETURN(const Setup setup, read_setup(arguments, record));
  const bool by_events = is_stream(arguments, setup);
  E2LF_RETURN_IF_ERROR(check_use(arguments, setup, by_events, verb));
  streams::StreamOptions stream;
  if (by_events) {
    E2LF_ASSIGN_OR_RETURN(stream, stream_options(arguments.stream, setup.known.event_model, setup.known.constants,
                                                 setup.camera, common.seed));
  }
  E2LF_ASSIGN_OR_RETURN(StreamScene scene,
                        open_stream_scene(arguments.input, arguments.stream, setup.scene, common.seed, common.quiet));
  E2LF_ASSIGN_OR_RETURN(const NextCycle next, by_events ? played_cycles(arguments, setup, stream, scene)
                                                        : counted_cycles(arguments, setup, scene, common.seed));
  record.end_step("read");
  E2LF_ASSIGN_OR_RETURN(SimulatedFile file, SimulatedFile::create(output.path(), arguments, setup, scene));
  ProgressBar bar("simulate", common.quiet);
  capture::Measurement first;
  uint64_t events = 0, lost = 0;
  const auto step = [&](size_t cycle) -> Result<bool> {
    bar.update(cycle, arguments.cycles);
    E2LF_ASSIGN_OR_RETURN(SimulatedCycle simulated, next(cycle));
    if (cycle == 0) first = simulated.measured;
    events += simulated.batch.events.size();
    lost = simulated.lost_events;
    E2LF_RETURN_IF_ERROR(file.add(std::move(simulated)));
    return cycle + 1 < arguments.cycles;
  };
  E2LF_RETURN_IF_ERROR(repeat_until_stopped(step));
  E2LF_RETURN_IF_ERROR(file.finish());
  hide_progress();
  if (by_events) record.note({{"events", events}, {"events_lost_to_readout", lost}});
  if (lost > 0) {
    log_warning(cat(lost, " of ", events + lost, " events waited too long for the readout and were lost"));
  }
  if (!output.is_stream() && !setup.as_images) record.note(pipeline::setup_notes(setup.recorded, output.path()));
  record.end_step("simulate");
  E2LF_RETURN_IF_ERROR(commit(output, record));
  print_measurement(first, common);
  if (!output.is_stream()) print_next_step(next_step(arguments, setup), common);
  return {};
}

void add_sensor_options(CLI::App& app, SimulateArguments& simulation) {
  const OptionGroup group(app, kSensorOptions);
  app.add_option("--event-model", simulation.event_model,
                 "quantised (Eq. 8), reference-aware (Eq. 9, 10), esim or v2e; default: the model's");
  app.add_option("--eps", simulation.eps, "dark level added to the intensity; default: the model's, or 0.01");
  app.add_option("--tau", simulation.tau, "contrast threshold; default: the model's, or 0.30");
  app.add_option("--sigma-w", simulation.sigma_w, "noise of the log intensity; default: the model's, or 0.175");
  app.add_option("--sigma-z", simulation.sigma_z, "noise of the threshold; default: the model's, or 0.04");
  app.add_option("--measurement", simulation.measurement,
                 "event-images, coded-images, hybrid or lens-array; default: the input of the model, or event-images");
  app.add_option("--sigma-i", simulation.sigma_i, "noise of intensity images; default: the model's, or 0.005");
  app.add_option(
         "--residue", simulation.residue,
         "maximum residual reference offset in thresholds (0 to 1): each reference starts at random up to this far "
         "above the black level, as in a real sensor after the change to black")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
}

}  // namespace

int run_simulate(const std::vector<std::string>& arguments) {
  Verb verb("simulate",
            "Simulate the event images or the recording that an event camera with a coded aperture makes "
            "of a light field.",
            "e2lf simulate scene/ -m e2lf-n4 -o events.npz --sigma-w 0.175 --seed 1");
  SimulateArguments simulation;
  CLI::App& app = verb.app();
  app.add_option("input,-i,--input", simulation.input, "light field: a folder of views, or any format e2lf reads");
  app.add_option("-o,--output", simulation.output, "event images (.npz) or a recording (.raw, .hdf5, .dat, .csv ...)")
      ->required();
  add_codes_options(app, simulation.codes);
  add_camera_option(app, simulation.camera, "the camera that records; default: the paper's event model");
  add_light_field_options(app, simulation.light_field, /*has_views=*/false);
  add_sensor_options(app, simulation);
  app.add_option("--scene-gain", simulation.scene_gain, "brightness of the scene relative to the light field")
      ->capture_default_str();
  add_count(app, "--cycles", simulation.cycles, 1, INT64_MAX, "number of pattern cycles, each with independent noise");
  app.add_flag("--no-triggers", simulation.no_triggers, "recordings: omit the trigger at the start of each pattern");
  add_stream_options(app, simulation.stream);
  app.callback([&simulation] {
    if (simulation.input.empty() && !simulation.stream.has_turntable()) throw CLI::RequiredError("input");
    if (!simulation.input.empty() && simulation.stream.has_turntable()) {
      throw CLI::ValidationError("--turntable", "replaces the input; leave the input out");
    }
  });
  verb.stop_gently();
  return verb.run(arguments, [&] { return simulate(simulation, verb); });
}

}  // namespace e2lf::cli
