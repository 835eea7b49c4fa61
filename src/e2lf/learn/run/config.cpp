// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/config.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/files/fields.h"
#include "e2lf/model/unet.h"

namespace e2lf::learn {
namespace {

// The fields of a configuration, which docs/training.md describes; see files/fields.h.

constexpr const char* kInputKindNames[] = {"counts", "cumulative", "intensity", "camera",
                                           "images", "image-sum",  "lens-array"};

template <typename Options>
auto synthesiser_fields(Options& options) {
  return [&options](auto& visit) {
    visit("size", options.size);
    visit("max_disparity", options.max_disparity);
    visit("max_layers", options.max_layers);
    visit("slant_share", options.slant_share);
    visit("highlight_share", options.highlight_share);
    visit("procedural_share", options.procedural_share);
    visit("motion_px_per_cycle", options.motion_px_per_cycle);
    visit("still_share", options.still_share);
  };
}

template <typename Data>
auto data_fields(Data& data) {
  return [&data](auto& visit) {
    visit("file", data.file);
    visit("validation", data.validation);
    visit("exclude", data.exclude);
    visit("synthetic_share", data.synthetic_share);
    visit("patch_stride", data.patch_stride);
    visit("pool", data.pool);
    visit("pool_per_step", data.pool_per_step);
    visit.section("synthesiser", synthesiser_fields(data.synthesiser));
  };
}

template <typename Patterns>
auto pattern_fields(Patterns& patterns) {
  return [&patterns](auto& visit) {
    visit("num_patterns", patterns.num_patterns);
    visit("black_first", patterns.black_first);
    visit("complementary", patterns.complementary);
    visit("whole_cycle", patterns.whole_cycle);
    visit.choice("event_model", patterns.event_model, capture::kEventModelNames);
    visit("codes", patterns.codes);
    visit("start", patterns.start);
    visit("noise_start", patterns.noise_start);
    visit("in_model", patterns.in_model);
    visit("begin_step", patterns.begin_step);
    visit("learn_steps", patterns.learn_steps);
    visit("learning_rate", patterns.learning_rate);
    visit("scale_begin", patterns.scale_begin);
    visit("scale_end", patterns.scale_end);
  };
}

template <typename Sensor>
auto sensor_fields(Sensor& sensor) {
  return [&sensor](auto& visit) {
    visit("eps", sensor.nominal.eps);
    visit("nominal_tau", sensor.nominal.tau);
    visit("nominal_sigma_w", sensor.nominal.sigma_w);
    visit("nominal_sigma_z", sensor.nominal.sigma_z);
    visit("sigma_i", sensor.nominal.sigma_i);
    visit("nominal_share", sensor.nominal_share);
    visit("noise_free_share", sensor.noise_free_share);
    visit("residue_share", sensor.residue_share);
    visit("tau", sensor.tau);
    visit("sigma_w", sensor.sigma_w);
    visit("sigma_z", sensor.sigma_z);
    visit("full_gain_share", sensor.full_gain_share);
    visit("gain", sensor.gain);
    visit("camera", sensor.camera);
    visit("camera_share", sensor.camera_share);
    visit("camera_nominal_share", sensor.camera_nominal_share);
    visit("camera_spread", sensor.camera_spread);
    visit("camera_wide_share", sensor.camera_wide_share);
    visit("camera_field_spread", sensor.camera_field_spread);
    visit("camera_gain", sensor.camera_gain);
    visit("cycles_share", sensor.cycles_share);
  };
}

template <typename Network>
auto network_fields(Network& network) {
  return [&network](auto& visit) {
    visit("type", network.type);
    visit("widths", network.widths);
    visit("blocks", network.blocks);
    visit("head_width", network.head_width);
    visit("head_blocks", network.head_blocks);
  };
}

template <typename Train>
auto train_fields(Train& train) {
  return [&train](auto& visit) {
    visit("patch", train.patch);
    visit("batch", train.batch);
    visit("steps", train.steps);
    visit("optimiser", train.optimiser);
    visit("learning_rate", train.learning_rate);
    visit("warmup_steps", train.warmup_steps);
    visit("hold_steps", train.hold_steps);
    visit("clip_norm", train.clip_norm);
    visit("ema", train.ema);
    visit("gain_weight_power", train.gain_weight_power);
    visit("error_power", train.error_power);
    visit("log_steps", train.log_steps);
    visit("evaluate_steps", train.evaluate_steps);
    visit("checkpoint_steps", train.checkpoint_steps);
  };
}

template <typename AnyConfig, typename Visitor>
void visit_fields(AnyConfig& config, Visitor& visit) {
  visit("name", config.name);
  visit("seed", config.seed);
  visit("device", config.device);
  visit("precision", config.precision);
  visit("start", config.start);
  visit.section("data", data_fields(config.data));
  visit.section("patterns", pattern_fields(config.patterns));
  visit.section("sensor", sensor_fields(config.sensor));
  visit.list("input", config.input, [](auto& group, auto& inner) {
    inner.choice("kind", group.kind, kInputKindNames);
    inner("scale", group.scale);
  });
  visit.section("network", network_fields(config.network));
  visit.section("train", train_fields(config.train));
}

Error invalid(const std::string& message, const std::string& location) {
  return fail(ErrorCode::kInvalidValue, location, message);
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
    return invalid("a lens array requires an open aperture; set num_patterns to 1 and black_first to false", location);
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

model::Network make_network(const Config& config) {
  const size_t num_patterns = config.patterns.num_patterns;
  size_t channels = 0;
  for (const model::InputGroup& group : config.input) {
    channels += model::num_input_channels({group}, num_patterns);
  }
  if (config.network.type == "recnet") return model::recnet(channels);
  return model::unet({.input_channels = channels,
                      .widths = {config.network.widths.begin(), config.network.widths.end()},
                      .blocks = {config.network.blocks.begin(), config.network.blocks.end()},
                      .head_width = config.network.head_width,
                      .head_blocks = config.network.head_blocks});
}

}  // namespace e2lf::learn
