// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/method_flags.h"

#include <cmath>
#include <cstdlib>

#include "e2lf/base/text.h"
#include "e2lf/cli/flags/option_values.h"

namespace e2lf::cli {
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
  add_choice(app, "--precision", flags.precision, {"auto", "float32", "bfloat16", "int16"},
             "arithmetic of the network: auto, float32, bfloat16 or int16");
  app.add_option("--gain", flags.gain,
                 "brightness of the output: auto (estimated from the first cycle) or a number; 1 = as computed")
      ->capture_default_str();
  app.add_option("--black", flags.black,
                 "brightness that becomes black: a number, or auto (0; with physical pixels and --gain auto, the "
                 "darkest parts of the first cycle)")
      ->capture_default_str();
}

Result<pipeline::MethodChoice> named_choice(const MethodFlags& flags, RunRecord& record) {
  pipeline::MethodChoice choice{.precision = flags.precision};
  E2LF_ASSIGN_OR_RETURN(choice.model, read_named_model(flags.codes, record));
  E2LF_ASSIGN_OR_RETURN(choice.codes, read_named_codes(flags.codes));
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
    return Error{ErrorCode::kInvalidValue, cat("\"", flags.gain, "\" is not a gain; give auto or a positive number"),
                 "--gain"};
  }
  if (flags.black != "auto" && !tone.black) {
    return Error{ErrorCode::kInvalidValue,
                 cat("\"", flags.black, "\" is not a brightness; give auto, 0 or a positive number"), "--black"};
  }
  return tone;
}

}  // namespace e2lf::cli
