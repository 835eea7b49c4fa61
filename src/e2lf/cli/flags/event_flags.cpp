// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/event_flags.h"

#include <cmath>
#include <cstdlib>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/info/file_kind.h"
#include "e2lf/program/options.h"
#include "e2lf/recordings/open/registry.h"

namespace e2lf::cli {
namespace fs = std::filesystem;

void add_camera_options(CLI::App& app, recordings::CameraSetup& camera) {
  const OptionGroup group(app, kCameraOptions);
  const auto add = [&](const char* name, auto& value, const char* text) { return app.add_option(name, value, text); };
  const auto repeat = [](CLI::Option* option) {
    option->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)->allow_extra_args(false);
  };
  const auto take_regions = [&camera](const CLI::results_t& texts) {
    camera.regions.clear();
    for (const std::string& text : texts) {
      const auto regions = recordings::parse_regions(text);
      if (!regions) throw CLI::ValidationError("--roi", regions.error().message);
      camera.regions.insert(camera.regions.end(), regions->begin(), regions->end());
    }
    return true;
  };
  repeat(add("--trigger-channel", camera.trigger_channels,
             "trigger input to enable: main, aux, the number of its triggers, or none (repeatable); default: all"));
  add("--biases", camera.biases, "file of sensor biases (.bias); default: those of the camera");
  add("--max-event-rate", camera.max_events_per_s,
      "events/s above which the sensor drops events, 0 = no limit; default: as set in the camera");
  repeat(app.add_option("--roi", take_regions,
                        "rectangle of the sensor whose pixels send events: X,Y,WIDTH,HEIGHT in px (repeatable)")
             ->type_name("TEXT"));
  add("--encoding", camera.encoding, "encoding of the camera's events; default: as set in the camera")
      ->check(CLI::IsMember({"evt2", "evt2.1", "evt3"}));
  app.add_flag("--no-sensor-filters", camera.switches_filters_off,
               "switch off the anti-flicker and event trail filters of the sensor, which drop events of the patterns");
}

namespace {

/// Declares what recordings may not state: format, sensor and columns.
void add_table_options(CLI::App& app, recordings::OpenOptions& open) {
  const OptionGroup group(app, kTableOptions);
  app.add_option("--event-format", open.format, "format of the recording, if it cannot be detected");
  app.add_option("--sensor-width", open.width, "width of the sensor in px, if the recording does not state it");
  app.add_option("--sensor-height", open.height, "height of the sensor in px, if the recording does not state it");
  app.add_option("--columns", open.columns, "order of the columns of a table of events, e.g. txyp; - skips a column");
  add_choice(app, "--time-unit", open.time_unit, recordings::kTimeUnits,
             "unit of the times in text, numpy and HDF5 tables: s, ms, us or ns; auto = as names state, otherwise us "
             "for whole numbers and s for fractions");
  app.add_option("--polarities", open.polarities,
                 "numbers of OFF and ON in a table of events, e.g. 1,2; default: 0,1 or -1,1");
}

/// Declares which events are read, and how their times are counted.
void add_range_options(CLI::App& app, RecordingFlags& flags) {
  const OptionGroup group(app, kRecordingOptions);
  app.add_option("--stream", flags.open.stream,
                 "number or name of a stream of events, if the recording contains several");
  add_choice(app, "--restart", flags.open.restart, recordings::kRestartPolicies,
             "if the clock starts again (a restarted camera, joined files): continue shifts the later part behind the "
             "earlier one, split keeps the parts separate (info, convert), refuse fails");
  app.add_option("--from-us", flags.open.from_us,
                 "recordings: leave out data before this time on the clock of the recording");
  app.add_option("--to-us", flags.open.to_us,
                 "recordings: leave out data at or after this time on the clock of the recording");
  app.add_flag("--relative", flags.is_relative,
               "recordings: --from-us and --to-us are relative to the first event or trigger");
}

}  // namespace

void add_recording_options(CLI::App& app, RecordingFlags& flags) {
  add_table_options(app, flags.open);
  add_range_options(app, flags);
  add_camera_options(app, flags.open.camera);
  app.add_flag("--strict", flags.is_strict,
               "fail and write nothing if events would be left out (damage, outside the sensor, count too large)");
}

bool is_live(const fs::path& input) {
  return recordings::is_live_recording(input.string());
}

Result<recordings::OpenOptions> open_options(const fs::path& input, const RecordingFlags& flags, bool reads_parts) {
  recordings::OpenOptions open = flags.open;
  if (open.from_us >= open.to_us) {
    return fail(ErrorCode::kInvalidValue, "--from-us", "the range from ", open.from_us, " to ", open.to_us,
                " us is empty; give a later --to-us");
  }
  if (open.restart == recordings::RestartPolicy::kSplit && !reads_parts) {
    return fail(ErrorCode::kInvalidValue, "--restart",
                "split is only for `e2lf info`, which lists the parts, and `e2lf convert`, which writes each to a "
                "separate file; convert the recording first, or use continue");
  }
  open.range = flags.is_relative ? recordings::TimeOrigin::kZero : recordings::TimeOrigin::kAbsolute;
  // With a camera, damage is reported at once; for a file, the summary at the end is sufficient.
  open.policy = flags.is_strict  ? recordings::DecodePolicy::kStrict
                : is_live(input) ? recordings::DecodePolicy::kReport
                                 : recordings::DecodePolicy::kSkip;
  return open;
}

namespace {

/// Declares how the times at which patterns change are found, which applies to recordings alone.
void add_change_options(CLI::App& app, CycleFlags& flags) {
  const OptionGroup group(app, kCycleOptions);
  add_choice(app, "--source", flags.events.cycles.source, kCycleSources,
             "source of the times at which patterns change: triggers, bursts (the events), schedule, auto");
  CLI::Option* const schedule =
      app.add_option("--schedule", flags.schedule,
                     "JSON: the patterns of a cycle and how long each is shown; default: the paper's")
          ->check(CLI::ExistingFile);
  app.add_option("--patterns", flags.events.schedule.num_patterns,
                 "number N of coding patterns of the paper's schedule; default: as the recording states, or else 4")
      ->check(whole_number(2, 64))
      ->excludes(schedule);
  add_choice(app, "--edge", flags.events.cycles.edge, cycles::kTriggerEdges, "trigger edge: rising, falling, both");
  app.add_option("--channel", flags.events.cycles.channel, "trigger input; default: all");
  app.add_option(
      "--first-pattern", flags.events.cycles.tracker.first_pattern,
      "pattern of the first trigger or burst, from 0; default: determined from the intervals and the events");
  app.add_flag("--one-trigger-per-cycle", flags.events.cycles.one_trigger_per_cycle,
               "triggers mark cycles, not patterns");
  app.add_option("--origin-us", flags.events.origin_us,
                 "--source schedule: the time at which the first pattern of any cycle began");
  app.add_option(
         "--trigger-delay-us", flags.events.cycles.trigger_delay_us,
         "time from a trigger to the change of the pattern, such as the latency of the display; negative if the "
         "pattern changes first")
      ->check(CLI::Range(-100'000, 100'000));
  app.add_flag("--filter-pixels", flags.events.cycles.filters_pixels, "give hot pixels the events of their neighbours");
}

}  // namespace

void add_cycle_options(CLI::App& app, CycleFlags& flags) {
  add_choice(app, "--transitions", flags.events.schedule.transitions, {"auto", "lit", "all"},
             "event images of the changes to the active patterns a2 ... aN (lit), or of all changes of the whole "
             "cycle (all); auto selects all if the network or the patterns of the recording require it; reconstruct "
             "then uses the lit ones in cycles during which the scene moves too much");
  app.add_flag("--invert-polarity", flags.events.cycles.invert_polarity, "exchange ON and OFF events");
  app.add_option("--max-cycles", flags.events.max_cycles, "maximum number of complete cycles; 0 = all")
      ->capture_default_str();
  add_change_options(app, flags);
  add_recording_options(app, flags.recording);
}

Result<std::unique_ptr<recordings::RecordingReader>> open_recording(const fs::path& input,
                                                                    const RecordingFlags& flags) {
  E2LF_ASSIGN_OR_RETURN(const recordings::OpenOptions open, open_options(input, flags));
  E2LF_ASSIGN_OR_RETURN(auto reader, recordings::open_named_recording(input.string(), open));
  log_assumptions(*reader);
  return reader;
}

namespace {

/// Returns the options for these flags, and reads the schedule that they name.
Result<pipeline::CycleInputOptions> cycle_input_options(const fs::path& input, const CycleFlags& flags) {
  pipeline::CycleInputOptions options = flags.events;
  options.input = input;
  options.is_strict = flags.recording.is_strict;
  if (!flags.schedule.empty()) {
    E2LF_ASSIGN_OR_RETURN(options.schedule.schedule, cycles::read_schedule(flags.schedule));
  }
  return options;
}

Result<pipeline::EventSource> open_events(const fs::path& input, const CycleFlags& flags, const Verb& verb) {
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(input));
  if (kind == FileKind::kRecording) {
    E2LF_ASSIGN_OR_RETURN(auto recording, open_recording(input, flags.recording));
    return pipeline::EventSource(std::move(recording));
  }
  if (kind != FileKind::kEventImages && kind != FileKind::kImages) {
    return other_kind_error(input, kind, "a recording or event images");
  }
  E2LF_RETURN_IF_ERROR(verb.refuse_options(kOptionsOfRecordings, kind_text(kind)));
  E2LF_ASSIGN_OR_RETURN(capture::MeasurementFile file, capture::read_measurements(input));
  return pipeline::EventSource(std::move(file));
}

}  // namespace

Result<cycles::CycleReader> open_cycles(const fs::path& input, const CycleFlags& flags,
                                        const pipeline::MethodChoice& method) {
  E2LF_ASSIGN_OR_RETURN(auto recording, open_recording(input, flags.recording));
  E2LF_ASSIGN_OR_RETURN(pipeline::CycleInputOptions options, cycle_input_options(input, flags));
  options.schedule = pipeline::wanted_schedule(std::move(options.schedule), method);
  return pipeline::open_cycles(std::move(recording), options);
}

Result<pipeline::CycleInput> open_cycle_input(const fs::path& input, const CycleFlags& flags, const Verb& verb,
                                              const pipeline::MethodChoice& method) {
  E2LF_ASSIGN_OR_RETURN(pipeline::EventSource events, open_events(input, flags, verb));
  E2LF_ASSIGN_OR_RETURN(pipeline::CycleInputOptions options, cycle_input_options(input, flags));
  options.schedule = pipeline::wanted_schedule(std::move(options.schedule), method);
  return pipeline::CycleInput::open(std::move(events), std::move(options));
}

void add_fuse_option(CLI::App& app, size_t& most_cycles, const char* result) {
  add_count(app, "--fuse", most_cycles, 1, recon::kMostFusedCycles,
            cat("make a ", result,
                " of each cycle, and average each pixel over up to this number of cycles, but none from before the "
                "scene changed there; for networks conditioned on the sensor profile"));
}

using pipeline::OpenedMethod;
using pipeline::StatedBy;
namespace {

/// Returns a finite number of at least 0, or nothing for "auto" or another text.
std::optional<float> brightness(const std::string& text) {
  char* end = nullptr;
  const float value = std::strtof(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value) || value < 0) return std::nullopt;
  return value;
}

}  // namespace

void add_method_options(CLI::App& app, MethodFlags& flags, const std::string& source) {
  add_codes_options(app, flags.codes);
  add_camera_option(app, flags.camera,
                    cat("the camera, for networks conditioned on the sensor profile; default: the one that ", source,
                        " states, or else the one for which the model was trained"));
  const OptionGroup group(app, kNetworkOptions);
  add_choice(app, "--precision", flags.choice.precision, {"auto", "float32", "bfloat16", "float16", "int16"},
             "arithmetic of the network: auto, float32, bfloat16, float16 (with --device cuda) or int16");
  add_device_option(app, flags.choice.device);
}

void add_tone_options(CLI::App& app, MethodFlags& flags) {
  const OptionGroup group(app, kNetworkOptions);
  app.add_option("--gain", flags.gain,
                 "brightness of the output: auto (estimated from the first cycle) or a number; 1 = as computed")
      ->capture_default_str();
  app.add_option("--black", flags.black,
                 "brightness that becomes black: a number, or auto (0; with physical pixels and --gain auto, the "
                 "darkest parts of the first cycle)")
      ->capture_default_str();
}

void add_device_option(CLI::App& app, std::string& device) {
  app.add_option("--device", device,
                 "what computes the network: cpu, or cuda or cuda:N in a build with torch (not tried on a GPU)")
      ->capture_default_str();
}

Result<pipeline::MethodChoice> named_choice(const MethodFlags& flags, RunRecord& record) {
  pipeline::MethodChoice choice = flags.choice;
  E2LF_ASSIGN_OR_RETURN(choice.model, read_named_model(flags.codes, record));
  if (!flags.codes.codes.empty()) {
    E2LF_ASSIGN_OR_RETURN(choice.codes, pipeline::read_patterns(flags.codes.codes));
    record.add_input(flags.codes.codes);
  }
  if (!flags.camera.empty()) {
    E2LF_ASSIGN_OR_RETURN(choice.camera, load_camera(flags.camera, record));
  }
  return choice;
}

Result<pipeline::Tone> tone_of(const MethodFlags& flags) {
  const pipeline::Tone tone{.gain = brightness(flags.gain), .black = brightness(flags.black)};
  if (flags.gain != "auto" && tone.gain.value_or(0) == 0) {
    return fail(ErrorCode::kInvalidValue, "--gain", "\"", flags.gain,
                "\" is not a gain; give auto or a positive number");
  }
  if (flags.black != "auto" && !(tone.black < 1.0F)) {
    return fail(ErrorCode::kInvalidValue, "--black", "\"", flags.black,
                "\" is not a brightness; give auto, or a number from 0 to less than 1, which is white");
  }
  return tone;
}

namespace {

/// Describes the source of the patterns or of the camera; `flag` is the flag that states them.
const char* stated_by_name(StatedBy stated_by, const char* flag) {
  if (stated_by == StatedBy::kCaller) return flag;
  if (stated_by == StatedBy::kEvents) return "the events' file";
  return stated_by == StatedBy::kModel ? "the model" : "nothing";
}

/// States which bundled network was chosen, and for which sensor.
void log_chosen_network(const OpenedMethod& method) {
  const std::string chosen = cat("no model was given; using ", method.network->model().name);
  if (method.camera && method.camera_stated_by == StatedBy::kModel) {
    log_info(cat(chosen, " with the profile of ", method.camera->name,
                 ", as no sensor is stated; give the one that recorded the events with --camera"));
  } else {
    const bool is_adapted = model::serves_any_patterns(method.network->model());
    log_info(cat(chosen,
                 is_adapted ? ", adapted to these patterns, for " : ", which was trained for these patterns and ",
                 method.camera && method.camera->is_pixel() ? "physical pixels" : "the paper's event model"));
  }
}

void record_network(const OpenedMethod& method, RunRecord& record) {
  const bool is_stated = pipeline::are_patterns_stated(method.codes);
  const StatedBy stated_by = is_stated ? method.codes->stated_by : StatedBy::kNone;
  record.note("patterns", {{"stated_by", stated_by_name(stated_by, "--codes")},
                           {"are_the_models", method.are_patterns_the_models()}});
  const char* precision = word_of(method.network->engine().precision(), engine::kPrecisions);
  record.resolve("precision", precision);
  record.note("precision", precision);
  record.note("passes", method.network->num_passes(method.use.passes));
}

}  // namespace

void record_method(const OpenedMethod& method, RunRecord& record) {
  if (method.camera && method.camera_stated_by != StatedBy::kNone) {
    record.note("camera", capture::to_json(*method.camera));
    record.note("camera_stated_by", stated_by_name(method.camera_stated_by, "--camera"));
  }
  if (method.bundled) {
    record.add_input(*method.bundled);
    for (const fs::path& part : method.network ? method.network->model().parts : std::vector<fs::path>()) {
      record.add_input(part);
    }
    record.resolve(method.network ? "model" : "codes", method.bundled->stem().string());
  }
  if (method.network) {
    if (method.bundled) log_chosen_network(method);
    record_network(method, record);
  }
  if (!method.codes) return;
  const capture::SensorConstants& constants = method.codes->constants;
  record.note("constants", {{"eps", json_number(constants.eps)},
                            {"tau", json_number(constants.tau)},
                            {"sigma_w", json_number(constants.sigma_w)},
                            {"sigma_z", json_number(constants.sigma_z)},
                            {"event_model", method.codes->event_model}});
}

Result<pipeline::EventRun> open_event_run(const fs::path& input, const CycleFlags& cycles, const MethodFlags& method,
                                          const OrientationFlags& turned, const Verb& verb, RunRecord& record) {
  pipeline::EventRunOptions options{.turned = turned.value()};
  E2LF_ASSIGN_OR_RETURN(options.method, named_choice(method, record));
  E2LF_ASSIGN_OR_RETURN(options.tone, tone_of(method));
  E2LF_ASSIGN_OR_RETURN(options.events, cycle_input_options(input, cycles));
  E2LF_ASSIGN_OR_RETURN(pipeline::EventSource events, open_events(input, cycles, verb));
  return pipeline::EventRun::open(std::move(events), std::move(options));
}

}  // namespace e2lf::cli
