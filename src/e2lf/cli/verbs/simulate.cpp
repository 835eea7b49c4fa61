// SPDX-License-Identifier: MIT
// e2lf simulate: simulates event images or a recording of a light field
#include <cstdio>
#include <functional>
#include <optional>

#include "e2lf/base/log.h"
#include "e2lf/base/stop.h"
#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/event_image_writer.h"
#include "e2lf/capture/measurement/measurement_io.h"
#include "e2lf/cli/flags/camera_option.h"
#include "e2lf/cli/flags/inputs.h"
#include "e2lf/cli/flags/number_check.h"
#include "e2lf/cli/flags/scene_input.h"
#include "e2lf/cli/output/next_step.h"
#include "e2lf/cli/output/output.h"
#include "e2lf/cli/output/run_record.h"
#include "e2lf/cli/verb.h"
#include "e2lf/cli/verbs/simulate_stream.h"
#include "e2lf/cycles/shown_pattern.h"
#include "e2lf/cycles/synthesise.h"
#include "e2lf/eval/event_statistics.h"
#include "e2lf/eval/report.h"
#include "e2lf/files/bundled_files.h"
#include "e2lf/files/options.h"
#include "e2lf/pipeline/recorded_setup.h"
#include "e2lf/pipeline/simulated_cycles.h"
#include "e2lf/recordings/open/registry.h"
#include "e2lf/sensor/event_model.h"
#include "e2lf/terminal/progress_bar.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
namespace {

struct SimulateArguments {
  fs::path input, output;
  CodesSource codes;
  std::string event_model, camera, measurement, colour_filter;
  std::optional<float> eps, tau, sigma_w, sigma_z, sigma_i;
  float scene_gain = 1.0F, residue = 0.0F;
  size_t cycles = 1;
  bool no_triggers = false;
  LightFieldFlags light_field;
  StreamFlags stream;
};

/// Returns the constants of the flags, or else those of the model, or else the paper's.
capture::SensorConstants constants_of(const SimulateArguments& arguments, const pipeline::KnownCodes& known) {
  return {.eps = arguments.eps.value_or(known.constants.eps),
          .tau = arguments.tau.value_or(known.constants.tau),
          .sigma_w = arguments.sigma_w.value_or(known.constants.sigma_w),
          .sigma_z = arguments.sigma_z.value_or(known.constants.sigma_z),
          .sigma_i = arguments.sigma_i.value_or(known.constants.sigma_i)};
}

/// Prints the number and size of intensity images, if there are any.
void print_images(const capture::Measurement& measured, const CommonOptions& common) {
  const capture::CodedIntensities& images = measured.images;
  if (images.count == 0) return;
  if (common.json && measured.events.count == 0) {
    const Json json = {{"measurement", capture::measurement_name(measured.kind)},
                       {"images", images.count},
                       {"height", images.height},
                       {"width", images.width}};
    std::printf("%s", json_text(json).c_str());
  } else if (!common.json && !common.quiet) {
    std::printf("%s: %zu intensity image%s of %zux%zu px\n", capture::measurement_name(measured.kind), images.count,
                images.count == 1 ? "" : "s", images.width, images.height);
  }
}

void print_statistics(const capture::EventImages& images, const CommonOptions& common) {
  if (images.count == 0) return;
  const eval::EventStatistics statistics = eval::event_statistics(images);
  if (common.json) {
    std::printf("%s", json_text(eval::to_json(statistics)).c_str());
  } else if (!common.quiet) {
    std::printf(
        "%zu transitions of %zux%zu px, %.2f events per pixel; a sensor of 1.066 G events/s needs at least %.1f ms\n",
        images.count, images.width, images.height, statistics.total_events_per_pixel, statistics.min_measurement_ms);
  }
}

/// Records the constants that were used.
void record_constants(const capture::SensorConstants& constants, const std::string& event_model, RunRecord& record) {
  record.resolve("event-model", event_model);
  record.resolve("eps", json_number(constants.eps));
  record.resolve("tau", json_number(constants.tau));
  record.resolve("sigma-w", json_number(constants.sigma_w));
  record.resolve("sigma-z", json_number(constants.sigma_z));
}

using MeasuredIn = std::function<Result<capture::Measurement>(uint64_t cycle)>;
using ImagesOf = std::function<Result<capture::EventImages>(uint64_t cycle)>;

/// Fails if constants of the paper's model are given for physical pixels.
Result<void> check_model_flags(const SimulateArguments& arguments, const capture::SensorProfile& camera) {
  const bool has_flags = arguments.eps || arguments.tau || arguments.sigma_w || arguments.sigma_z ||
                         arguments.residue != 0.0F || !arguments.event_model.empty();
  if (!camera.is_pixel() || !has_flags) return {};
  return Error{
      ErrorCode::kInvalidValue,
      cat("--event-model, --eps, --tau, --sigma-w, --sigma-z and --residue belong to the paper's model; leave ",
          "them out, or change the constants in a camera file of your own"),
      "--camera " + arguments.camera};
}

Result<void> write_images(const SimulateArguments& arguments, const fs::path& path, const capture::RecordedSetup& setup,
                          const ImagesOf& images_of) {
  E2LF_ASSIGN_OR_RETURN(capture::EventImageWriter writer, capture::EventImageWriter::create(path));
  writer.keep(setup);
  for (size_t cycle = 0; cycle < arguments.cycles && !(cycle > 0 && stop_requested()); ++cycle) {
    E2LF_ASSIGN_OR_RETURN(const capture::EventImages images, images_of(cycle));
    E2LF_RETURN_IF_ERROR(writer.add(images));
  }
  return writer.finish();
}

/// Writes a recording like that of the paper's camera: the inverse patterns, then the patterns, with a burst of events
/// after each change.
Result<void> write_recording(const SimulateArguments& arguments, const fs::path& path,
                             const capture::RecordedSetup& setup, const lightfield::Shape& shape,
                             const ImagesOf& images_of) {
  E2LF_ASSIGN_OR_RETURN(const auto writer, create_simulated_recording(path, arguments.output, setup, shape.height,
                                                                      shape.width, !arguments.no_triggers));
  cycles::SynthesisOptions synthesis;
  synthesis.schedule = cycles::paper_schedule_of(*setup.codes);
  if (arguments.no_triggers) synthesis.trigger_channel.reset();
  E2LF_RETURN_IF_ERROR(cycles::synthesise_recording(*writer, arguments.cycles, synthesis, images_of));
  return writer->finish();
}

Result<OutputFile> open_output(const SimulateArguments& arguments, bool as_images, bool overwrite) {
  OutputRules rules{.inputs = {arguments.input, arguments.codes.model, arguments.codes.codes, arguments.camera,
                               arguments.stream.schedule},
                    .overwrite = overwrite};
  if (!as_images) {
    E2LF_ASSIGN_OR_RETURN(const recordings::Codec* codec, recordings::codec_to_write(arguments.output, ""));
    rules.streams = codec->create != nullptr;
    rules.side_file = codec->side_file;
  }
  return OutputFile::create(arguments.output, rules);
}

/// Patterns, camera and event model.
struct Setup {
  pipeline::KnownCodes known;
  std::optional<capture::SensorProfile> camera;
  std::optional<capture::Orientation> views;  ///< as the camera or the schedule states
  [[nodiscard]] bool is_pixel() const { return camera && camera->is_pixel(); }
};

Result<Setup> read_setup(const SimulateArguments& arguments, RunRecord& record) {
  Setup setup;
  E2LF_ASSIGN_OR_RETURN(setup.known, load_codes(arguments.codes, record));
  if (!arguments.camera.empty()) {
    E2LF_ASSIGN_OR_RETURN(setup.camera, load_camera(arguments.camera, record));
    E2LF_RETURN_IF_ERROR(check_model_flags(arguments, *setup.camera));
    setup.known.constants = setup.camera->constants;
    if (!setup.is_pixel()) setup.known.event_model = setup.camera->event_model;
    setup.views = setup.camera->views;
  }
  if (!setup.views && !arguments.stream.schedule.empty()) {
    E2LF_ASSIGN_OR_RETURN(const cycles::Schedule schedule, cycles::read_schedule(arguments.stream.schedule));
    setup.views = schedule.views;
  }
  if (!arguments.event_model.empty()) setup.known.event_model = arguments.event_model;
  if (!arguments.measurement.empty()) {
    E2LF_ASSIGN_OR_RETURN(setup.known.measurement, capture::measurement_from_name(arguments.measurement));
  }
  record.resolve("measurement", capture::measurement_name(setup.known.measurement));
  if (!setup.is_pixel()) record_constants(constants_of(arguments, setup.known), setup.known.event_model, record);
  return setup;
}

/// Returns the options for a scene with one view for each cell of the patterns, in the orientation that the camera
/// sees.
Result<SceneOptions> scene_options(const SimulateArguments& arguments, const Setup& setup) {
  SceneOptions options{arguments.light_field, setup.known.codes.views_y, setup.known.codes.views_x};
  if (setup.views) options.flags.orientation = {false, setup.views->flip_x, setup.views->flip_y};
  if (arguments.colour_filter.empty()) return options;
  if (arguments.stream.has_turntable()) {
    return Error{ErrorCode::kInvalidValue, "the turntable is grey; leave the colour filter out", "--colour-filter"};
  }
  E2LF_ASSIGN_OR_RETURN(options.filter, capture::colour_filter_from_name(arguments.colour_filter));
  return options;
}

/// Returns the setup that is stored in the result. It has no camera for ESIM and v2e, which camera files do not
/// support.
capture::RecordedSetup recorded_setup(const SimulateArguments& arguments, const Setup& setup) {
  capture::RecordedSetup recorded{setup.known.codes, setup.camera, setup.views};
  if (setup.is_pixel()) return recorded;
  if (!sensor::event_model_from_name(setup.known.event_model)) return {setup.known.codes, std::nullopt, setup.views};
  capture::SensorProfile& camera = recorded.camera ? *recorded.camera : recorded.camera.emplace();
  camera.event_model = setup.known.event_model;
  camera.constants = constants_of(arguments, setup.known);
  return recorded;
}

/// Returns true if events must be simulated one by one. Recordings of the paper's models are otherwise generated from
/// counts per pattern.
bool is_stream(const SimulateArguments& arguments, const Setup& setup, bool as_images) {
  if (need_stream(arguments.stream) || (setup.is_pixel() && !as_images)) return true;
  const std::string& model = setup.known.event_model;
  return !sensor::event_model_from_name(model) && streams::stream_model_from_name(model);
}

Result<capture::Measurement> run_stream(const SimulateArguments& arguments, const Setup& setup, const fs::path& place,
                                        const CommonOptions& common, RunRecord& record) {
  if (arguments.residue != 0.0F) {
    return Error{ErrorCode::kInvalidValue,
                 "--residue does nothing event by event, where earlier events say where references are; leave it out",
                 ""};
  }
  StreamRun run;
  run.input = arguments.input;
  run.flags = arguments.stream;
  E2LF_ASSIGN_OR_RETURN(run.scene, scene_options(arguments, setup));
  run.codes = setup.known.codes;
  run.camera = setup.camera.value_or(capture::SensorProfile{});
  E2LF_ASSIGN_OR_RETURN(run.stream, stream_options(arguments.stream, setup.known.event_model,
                                                   constants_of(arguments, setup.known), setup.camera, common.seed));
  run.recorded = recorded_setup(arguments, setup);
  run.gain = arguments.scene_gain;
  run.cycles = arguments.cycles;
  run.is_quiet = common.quiet;
  run.has_triggers = !arguments.no_triggers;
  if (!arguments.stream.schedule.empty()) record.add_input(arguments.stream.schedule);
  E2LF_ASSIGN_OR_RETURN(capture::EventImages first, simulate_stream(run, place, arguments.output, record));
  return capture::Measurement(std::move(first));
}

pipeline::SimulatedCamera camera_of(const SimulateArguments& arguments, const Setup& setup, uint64_t seed) {
  pipeline::SimulatedCamera camera{.measurement = setup.known.measurement,
                                   .codes = setup.known.codes,
                                   .profile = setup.camera.value_or(capture::SensorProfile{}),
                                   .gain = arguments.scene_gain,
                                   .residue = arguments.residue,
                                   .seed = seed};
  camera.profile.constants = constants_of(arguments, setup.known);
  if (!setup.is_pixel()) camera.profile.event_model = setup.known.event_model;
  return camera;
}

/// Writes intensity images and, if the measurement has any, event images.
Result<void> write_measurements(const SimulateArguments& arguments, const fs::path& path,
                                const capture::RecordedSetup& setup, const MeasuredIn& measured_in) {
  capture::MeasurementFile file{{}, setup};
  for (size_t cycle = 0; cycle < arguments.cycles && !(cycle > 0 && stop_requested()); ++cycle) {
    E2LF_ASSIGN_OR_RETURN(capture::Measurement measured, measured_in(cycle));
    file.cycles.push_back(std::move(measured));
  }
  return capture::write_measurements(path, file);
}

/// Simulates the counts of each pattern; in a recording, the events are distributed over its duration.
Result<capture::Measurement> run_counts(const SimulateArguments& arguments, const Setup& setup, const fs::path& place,
                                        const CommonOptions& common, RunRecord& record) {
  E2LF_RETURN_IF_ERROR(sensor::event_model_from_name(setup.known.event_model));
  E2LF_ASSIGN_OR_RETURN(const SceneOptions options, scene_options(arguments, setup));
  E2LF_ASSIGN_OR_RETURN(const lightfield::LightField scene, load_scene(arguments.input, options, common.quiet));
  record.end_step("read");
  const pipeline::SimulatedCamera camera = camera_of(arguments, setup, common.seed);
  ProgressBar bar("simulate", common.quiet);
  capture::Measurement first;
  const MeasuredIn measured_in = [&](uint64_t cycle) {
    bar.update(cycle, arguments.cycles);
    auto measured = pipeline::simulate_cycle(camera, scene, cycle);
    if (measured && cycle == 0) first = *measured;
    return measured;
  };
  const ImagesOf images_of = [&](uint64_t cycle) -> Result<capture::EventImages> {
    E2LF_ASSIGN_OR_RETURN(capture::Measurement measured, measured_in(cycle));
    return std::move(measured.events);
  };
  const capture::RecordedSetup recorded = recorded_setup(arguments, setup);
  if (setup.known.measurement != capture::MeasurementKind::kEventImages) {
    E2LF_RETURN_IF_ERROR(write_measurements(arguments, place, recorded, measured_in));
  } else if (arguments.output.extension() == ".npz") {
    E2LF_RETURN_IF_ERROR(write_images(arguments, place, recorded, images_of));
  } else {
    E2LF_RETURN_IF_ERROR(write_recording(arguments, place, recorded, scene.shape(), images_of));
  }
  return first;
}

/// Fails if an option would have no effect.
Result<void> check_use(const SimulateArguments& arguments, const Setup& setup, bool as_images, bool is_stream,
                       const Verb& verb) {
  const bool has_intensities = setup.known.measurement != capture::MeasurementKind::kEventImages;
  if (has_intensities && (!as_images || is_stream)) {
    return Error{ErrorCode::kInvalidValue,
                 cat("the measurement ", capture::measurement_name(setup.known.measurement),
                     " is not a stream of events; write an .npz, without options of streams"),
                 arguments.output.string()};
  }
  if (!has_intensities && arguments.sigma_i) {
    return Error{ErrorCode::kInvalidValue, "event images have no noise of intensity images; leave it out", "--sigma-i"};
  }
  const auto useless = [](const char* flag, const char* why) {
    return Error{ErrorCode::kInvalidValue, cat(why, "; leave it out"), flag};
  };
  if (has_intensities && !arguments.colour_filter.empty()) {
    return useless("--colour-filter", "colours can only be reconstructed from event images");
  }
  if (as_images && arguments.no_triggers) return useless("--no-triggers", "event images do not contain triggers");
  if (!is_stream) return verb.refuse_options(kStreamOptions, "counts of whole patterns");
  const StreamFlags defaults;
  const bool is_v2e = !setup.is_pixel() && setup.known.event_model == "v2e";
  if (arguments.stream.v2e_preset != defaults.v2e_preset && !is_v2e) {
    return useless("--v2e-preset", "the events are not those of the model v2e");
  }
  const bool has_size = arguments.stream.width != defaults.width || arguments.stream.height != defaults.height;
  if (has_size && !arguments.stream.has_turntable()) {
    return useless("--width, --height", "the size is that of the input");
  }
  return {};
}

/// Returns the flags with which these events can be reconstructed. Networks for the patterns of bundled models are
/// found automatically; for other patterns, the closed form is suggested.
std::string network_flags(const SimulateArguments& arguments, const Setup& setup) {
  const fs::path& model = arguments.codes.model;
  if (!model.empty() && model == bundled_model()) return "";
  if (!model.empty()) return " -m " + shell_word(shown_name(kBundledModels, model));
  if (setup.known.measurement != capture::MeasurementKind::kEventImages) return " -m MODEL";
  const fs::path& codes = arguments.codes.codes;
  return codes.empty() || shown_name(kBundledModels, codes) != codes ? "" : " --method inversion";
}

std::string next_step(const SimulateArguments& arguments, const Setup& setup, bool as_images) {
  const std::string events = shell_word(arguments.output.string());
  fs::path result = arguments.output;
  if (!as_images) return cat("e2lf accumulate ", events, " -o ", shell_word(result.replace_extension(".npz").string()));
  result.replace_extension();
  return cat("e2lf reconstruct ", events, network_flags(arguments, setup), " -o ",
             shell_word(result.string() + "-lightfield"));
}

Result<void> simulate(const SimulateArguments& arguments, const Verb& verb) {
  const bool as_images = arguments.output.extension() == ".npz";
  E2LF_ASSIGN_OR_RETURN(OutputFile output, open_output(arguments, as_images, verb.common().overwrite));
  RunRecord record("simulate");
  if (!arguments.input.empty()) record.add_input(arguments.input);
  E2LF_ASSIGN_OR_RETURN(const Setup setup, read_setup(arguments, record));
  const bool by_events = is_stream(arguments, setup, as_images);
  E2LF_RETURN_IF_ERROR(check_use(arguments, setup, as_images, by_events, verb));
  const auto run = by_events ? run_stream : run_counts;
  E2LF_ASSIGN_OR_RETURN(const capture::Measurement first, run(arguments, setup, output.path(), verb.common(), record));
  hide_progress();
  if (!as_images && !output.is_stream())
    record.note(pipeline::setup_notes(recorded_setup(arguments, setup), output.path()));
  if (!output.is_stream()) record.note(pipeline::colour_filter_notes(arguments.colour_filter, output.path()));
  record.end_step("simulate");
  if (!output.is_stream()) E2LF_RETURN_IF_ERROR(record.write(output.record_path(), verb));
  E2LF_RETURN_IF_ERROR(output.commit());
  print_images(first, verb.common());
  print_statistics(first.events, verb.common());
  if (!output.is_stream()) print_next_step(next_step(arguments, setup, as_images), verb.common());
  return {};
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
  app.add_option(
      "--colour-filter", simulation.colour_filter,
      "colour filters over each 2x2 pixels of the sensor, row by row, such as rggb; the input must have colour, and "
      "each of its pixels corresponds to such a block");
  add_light_field_options(app, simulation.light_field, /*has_views=*/false);
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
  app.add_option("--scene-gain", simulation.scene_gain, "brightness of the scene relative to the light field")
      ->capture_default_str();
  app.add_option("--cycles", simulation.cycles, "number of pattern cycles, each with independent noise")
      ->check(whole_number(1))
      ->capture_default_str();
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
