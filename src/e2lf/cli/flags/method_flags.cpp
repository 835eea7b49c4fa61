// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/method_flags.h"

#include <cmath>
#include <cstdlib>

#include "e2lf/base/log.h"
#include "e2lf/base/text.h"
#include "e2lf/program/option_values.h"

namespace e2lf::cli {
namespace fs = std::filesystem;
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
  add_choice(app, "--precision", flags.precision, {"auto", "float32", "bfloat16", "float16", "int16"},
             "arithmetic of the network: auto, float32, bfloat16, float16 (with --device cuda) or int16");
  add_device_option(app, flags.device);
}

void add_tone_options(CLI::App& app, MethodFlags& flags) {
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
  pipeline::MethodChoice choice{.precision = flags.precision, .device = flags.device};
  E2LF_ASSIGN_OR_RETURN(choice.model, read_named_model(flags.codes, record));
  if (!flags.codes.codes.empty()) {
    E2LF_ASSIGN_OR_RETURN(choice.codes, pipeline::read_patterns(flags.codes.codes));
  }
  return choice;
}

Result<void> complete_choice(const MethodFlags& flags, capture::RecordedSetup events, RunRecord& record,
                             pipeline::MethodChoice& choice) {
  choice.events = std::move(events);
  if (!flags.camera.empty()) {
    E2LF_ASSIGN_OR_RETURN(choice.camera, load_camera(flags.camera, record));
  }
  note_named_codes(flags.codes, choice.codes, choice.events.codes, record);
  return {};
}

Result<pipeline::Tone> tone_of(const MethodFlags& flags) {
  const pipeline::Tone tone{.gain = brightness(flags.gain), .black = brightness(flags.black)};
  if (flags.gain != "auto" && tone.gain.value_or(0) == 0) {
    return fail(ErrorCode::kInvalidValue, "--gain", "\"", flags.gain,
                "\" is not a gain; give auto or a positive number");
  }
  if (flags.black != "auto" && !tone.black) {
    return fail(ErrorCode::kInvalidValue, "--black", "\"", flags.black,
                "\" is not a brightness; give auto, 0 or a positive number");
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

void say_taken(const std::string& name, bool is_for_pixels) {
  log_info(cat("no model was given; using ", name, ", which was trained for these patterns and ",
               is_for_pixels ? "physical pixels" : "the paper's event model"));
}

/// The recording of a camera does not state its patterns. The check against the events finds out if they are others.
void note_assumed_patterns(const fs::path& events, const std::string& whose) {
  log_info(cat(events.string(), " does not state which patterns the camera showed; those of ", whose, " are assumed"));
}

/// Records the source of the patterns, and warns unless the network was trained for them.
void note_patterns(const OpenedMethod& method, const fs::path& events, RunRecord& record) {
  const model::Model& model = method.network->model();
  const bool is_stated = pipeline::are_patterns_stated(method.codes);
  const StatedBy stated_by = is_stated ? method.codes->stated_by : StatedBy::kNone;
  record.note("patterns", {{"stated_by", stated_by_name(stated_by, "--codes")},
                           {"are_the_models", method.are_patterns_the_models()}});
  if (method.are_patterns_the_models()) return;
  if (!is_stated) return note_assumed_patterns(events, model.name);
  log_warning(model.codes
                  ? cat("the events were made with other patterns than ", model.name,
                        " was trained for, so that the light field will be wrong; use a model for these patterns, or ",
                        "--method inversion")
                  : cat(model.name, " does not state which patterns it was trained for, so that it may not match ",
                        "those of the events"));
}

void note_network(const OpenedMethod& method, const fs::path& events, size_t passes, RunRecord& record) {
  const recon::Reconstructor& network = *method.network;
  const bool is_pixel = method.camera && method.camera->is_pixel();
  if (method.bundled) say_taken(network.model().name, is_pixel && method.camera_stated_by != StatedBy::kModel);
  note_patterns(method, events, record);
  if (!method.takes_sums() && is_pixel) {
    log_warning(cat("the events are those of physical pixels (", method.camera->name, "), which ", network.model().name,
                    " was not trained for: the light field will be wrong; use a network conditioned on the sensor "
                    "profile, such as ",
                    "e2lf-n4-camera"));
  }
  const size_t made = network.num_passes(passes);
  if (made < passes) {
    log_warning(cat("--passes ", passes, ": the network distinguishes ", made, " position", made == 1 ? "" : "s",
                    " on its pixel grid; the number of passes is reduced to this"));
  }
  const char* precision = word_of(network.engine().precision(), engine::kPrecisions);
  record.resolve("precision", precision);
  record.note("precision", precision);
  record.note("passes", made);
}

void say_classical(const OpenedMethod& method, const fs::path& events, const fs::path& model) {
  if (method.bundled) log_info(cat("no patterns were given; using those of ", method.bundled->stem().string()));
  if (method.codes->stated_by == StatedBy::kNone) {
    log_warning("the camera may have shown other patterns; give those of the camera with --codes");
  } else if (!pipeline::are_patterns_stated(method.codes)) {
    note_assumed_patterns(events, model.string());
  }
  if (method.camera && method.camera->is_pixel()) {
    log_warning(cat("the events are those of physical pixels (", method.camera->name, "); the method ",
                    method.algorithm, " only supports the paper's event model"));
  }
}

}  // namespace

void note_method(const OpenedMethod& method, const fs::path& events, const fs::path& model, size_t passes,
                 RunRecord& record) {
  if (method.camera && method.camera_stated_by != StatedBy::kNone) {
    record.note("camera", capture::to_json(*method.camera));
    record.note("camera_stated_by", stated_by_name(method.camera_stated_by, "--camera"));
  }
  if (method.bundled) {
    record.add_input(*method.bundled);
    record.resolve(method.network ? "model" : "codes", method.bundled->stem().string());
  }
  if (method.network) {
    note_network(method, events, passes, record);
  } else {
    say_classical(method, events, model);
  }
  if (!method.codes) return;
  const capture::SensorConstants& constants = method.codes->constants;
  record.note("constants", {{"eps", json_number(constants.eps)},
                            {"tau", json_number(constants.tau)},
                            {"sigma_w", json_number(constants.sigma_w)},
                            {"sigma_z", json_number(constants.sigma_z)},
                            {"event_model", method.codes->event_model}});
}

}  // namespace e2lf::cli
