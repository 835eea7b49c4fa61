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
  const OptionGroup group(app, kNetworkOptions);
  add_choice(app, "--precision", flags.precision, {"auto", "float32", "bfloat16", "float16", "int16"},
             "arithmetic of the network: auto, float32, bfloat16, float16 (with --device cuda) or int16");
  add_device_option(app, flags.device);
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
  pipeline::MethodChoice choice{.precision = flags.precision, .device = flags.device};
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

void record_network(const OpenedMethod& method, size_t passes, RunRecord& record) {
  const bool is_stated = pipeline::are_patterns_stated(method.codes);
  const StatedBy stated_by = is_stated ? method.codes->stated_by : StatedBy::kNone;
  record.note("patterns", {{"stated_by", stated_by_name(stated_by, "--codes")},
                           {"are_the_models", method.are_patterns_the_models()}});
  const char* precision = word_of(method.network->engine().precision(), engine::kPrecisions);
  record.resolve("precision", precision);
  record.note("precision", precision);
  record.note("passes", method.network->num_passes(passes));
}

}  // namespace

void record_method(const OpenedMethod& method, size_t passes, RunRecord& record) {
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
    record_network(method, passes, record);
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
