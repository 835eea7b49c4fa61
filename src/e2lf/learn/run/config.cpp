// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/config.h"

#include <algorithm>

#include "e2lf/files/fields.h"
#include "e2lf/learn/run/config_fields.h"
#include "e2lf/model/unet.h"

namespace e2lf::learn {
namespace {

Error invalid(const std::string& message, const std::string& location) {
  return Error{ErrorCode::kInvalidValue, message, location};
}

bool is_intensity(const model::InputGroup& group) {
  return group.kind == model::InputKind::kIntensity;
}

Result<void> check_patterns(const PatternConfig& patterns, capture::MeasurementKind measurement,
                            const std::string& location) {
  if (patterns.complementary && (patterns.black_first || patterns.num_patterns % 2 != 0)) {
    return invalid(
        "complementary patterns come in pairs, none of them black; set black_first to false and an even "
        "num_patterns",
        location);
  }
  if (patterns.whole_cycle && (!patterns.black_first || patterns.num_patterns < 5 || patterns.num_patterns % 2 == 0)) {
    return invalid(
        "a whole cycle begins and ends with black: leave black_first at true and set num_patterns to 2N + 1 for N "
        "codes, at least 5",
        location);
  }
  const size_t least = patterns.black_first || capture::has_events(measurement) ? 2 : 1;
  if (patterns.num_patterns < least)
    return invalid(cat("num_patterns must be at least ", least, "; raise it"), location);
  if (measurement == capture::MeasurementKind::kLensArray && patterns.num_patterns != 1) {
    return invalid("behind a lens array the aperture is open; set num_patterns to 1 and black_first to false",
                   location);
  }
  return {};
}

Result<void> check_sensor(const SensorConfig& sensor, const std::string& start, const std::string& location) {
  if (sensor.subwindows == 1) return {};
  if (sensor.subwindows == 0 || sensor.camera.empty() || sensor.camera_share < 1.0 || !start.empty()) {
    return invalid("sub-windows need physical pixels in all samples: set camera, camera_share to 1 and no start",
                   location + ".subwindows");
  }
  return {};
}

Result<void> check_network(const NetworkConfig& network, const std::string& location) {
  if (network.type != "unet" && network.type != "recnet") {
    return invalid(cat("unknown network type \"", network.type, "\"; use unet or recnet"), location);
  }
  if (network.widths.empty() || network.widths.size() != network.blocks.size()) {
    return invalid("widths and blocks need one entry per level; make the lists equally long", location);
  }
  return {};
}

Result<void> check_train(const TrainConfig& train, const std::string& location) {
  if (train.batch == 0 || train.steps == 0 || train.patch == 0 || train.log_steps == 0 || train.evaluate_steps == 0 ||
      train.checkpoint_steps == 0) {
    return invalid("patch, batch, steps and the intervals must be positive; raise them", location);
  }
  if (train.optimiser != "muon" && train.optimiser != "adam") {
    return invalid(cat("unknown optimiser \"", train.optimiser, "\"; use muon or adam"), location);
  }
  if (!(train.error_power > 0.0)) return invalid("error_power must be positive; 1 is the squared error", location);
  return {};
}

}  // namespace

Result<Config> config_from_json(const Json& json, const std::string& location) {
  Config config;
  // Without a black first pattern, counts measure changes of the intensity, but not the intensity.
  const Json& patterns = json.is_object() && json.contains("patterns") ? json["patterns"] : Json();
  const bool is_black_first = !patterns.is_object() || patterns.value("black_first", Json(true)) != Json(false);
  if (!is_black_first) std::erase_if(config.input, is_intensity);
  FieldReader reader(json, location);
  visit_fields(config, reader);
  E2LF_RETURN_IF_ERROR(reader.finish());
  if (!is_black_first && std::any_of(config.input.begin(), config.input.end(), is_intensity)) {
    return invalid("intensity inputs need a black first pattern; leave them out or set patterns.black_first",
                   location + ".input");
  }
  const auto measurement = model::measurement_of(config.input);
  if (!measurement) return invalid(measurement.error().message, location + ".input");
  E2LF_RETURN_IF_ERROR(check_patterns(config.patterns, *measurement, location + ".patterns"));
  if (!config.sensor.camera.empty() && !capture::has_events(*measurement)) {
    return invalid("a camera with physical pixels generates events, but `input` contains none; leave the camera out",
                   location + ".sensor.camera");
  }
  if (*measurement == capture::MeasurementKind::kLensArray && config.train.patch % capture::kLensPixels != 0) {
    return invalid("a patch must contain an integral number of lenses; make it a multiple of 8",
                   location + ".train.patch");
  }
  E2LF_RETURN_IF_ERROR(check_sensor(config.sensor, config.start, location + ".sensor"));
  E2LF_RETURN_IF_ERROR(check_network(config.network, location + ".network"));
  E2LF_RETURN_IF_ERROR(check_train(config.train, location + ".train"));
  if (config.precision != "float32" && config.precision != "bfloat16") {
    return invalid("precision is \"float32\" or \"bfloat16\"; write one of them", location + ".precision");
  }
  if (config.data.synthesiser.size < static_cast<int64_t>(config.train.patch)) {
    return invalid("synthesised light fields are smaller than a patch; raise data.synthesiser.size",
                   location + ".train.patch");
  }
  return config;
}

Json to_json(const Config& config) {
  FieldWriter writer;
  visit_fields(config, writer);
  return std::move(writer).json();
}

std::string config_table() {
  FieldTable table;
  const Config defaults;
  visit_fields(defaults, table);
  return table.rows();
}

model::Network make_network(const Config& config) {
  const size_t num_patterns = config.patterns.num_patterns;
  size_t channels = 0;
  for (const model::InputGroup& group : config.input) {
    // Otherwise, a sub-window is to the inputs what a transition is.
    const bool is_of_patterns = group.kind == model::InputKind::kCamera || config.sensor.subwindows == 1;
    const size_t seen = is_of_patterns ? num_patterns : (num_patterns - 1) * config.sensor.subwindows + 1;
    channels += model::num_input_channels({group}, seen);
  }
  if (config.network.type == "recnet") return model::recnet(channels);
  return model::unet({.input_channels = channels,
                      .widths = {config.network.widths.begin(), config.network.widths.end()},
                      .blocks = {config.network.blocks.begin(), config.network.blocks.end()},
                      .head_width = config.network.head_width,
                      .head_blocks = config.network.head_blocks});
}

}  // namespace e2lf::learn
