// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/config.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/files/fields.h"
#include "e2lf/model/unet.h"

namespace e2lf::learn {
namespace {

// The fields of a configuration, which reading, writing and the table in docs/training.md share; see files/fields.h.

constexpr const char* kInputKindNames[] = {"counts", "cumulative", "intensity", "camera",
                                           "images", "image-sum",  "lens-array"};

template <typename Options>
auto synthesiser_fields(Options& options) {
  return [&options](auto& visit) {
    visit("size", options.size, "height and width of a synthesised light field, px");
    visit("max_disparity", options.max_disparity, "largest absolute disparity, px per view step");
    visit("max_layers", options.max_layers, "largest number of surfaces");
    visit("slant_share", options.slant_share, "share of surfaces whose disparity varies over the image");
    visit("highlight_share", options.highlight_share, "share of scenes with reflections at a depth of their own");
    visit("procedural_share", options.procedural_share,
          "share of surfaces with a procedural texture in place of a photograph");
    visit("motion_px_per_cycle", options.motion_px_per_cycle,
          "largest speed of a surface in px per cycle of the display; the network learns the light field at the time "
          "of the last pattern");
    visit("still_share", options.still_share, "share of synthesised scenes that stand still if others move");
  };
}

template <typename Data>
auto data_fields(Data& data) {
  return [&data](auto& visit) {
    visit("file", data.file, "packed data, made by `e2lf pack`; if empty, only procedural textures are used");
    visit("validation", data.validation,
          "scenes that are evaluated and never trained on; if empty, two synthesised light fields are evaluated");
    visit("exclude", data.exclude, "scenes that are neither trained on nor evaluated");
    visit("synthetic_share", data.synthetic_share, "share of synthesised samples");
    visit("patch_stride", data.patch_stride,
          "patches of light fields begin at multiples of this, or anywhere if it is 0; the protocol of BasicLFSR is 32 "
          "with patches of 64");
    visit("pool", data.pool, "number of synthesised light fields that are kept");
    visit("pool_per_step", data.pool_per_step, "number of them that are replaced per step");
    visit.section("synthesiser", synthesiser_fields(data.synthesiser));
  };
}

template <typename Patterns>
auto pattern_fields(Patterns& patterns) {
  return [&patterns](auto& visit) {
    visit("num_patterns", patterns.num_patterns, "number of patterns N");
    visit("black_first", patterns.black_first, "whether the first pattern is black");
    visit("complementary", patterns.complementary,
          "whether every second pattern is the inverse of the one before, so that all cells are open equally long; "
          "excludes `black_first`");
    visit("whole_cycle", patterns.whole_cycle,
          "whether the patterns are the codes, their inverses and black again, as a display shows them; `num_patterns` "
          "is then twice the number of codes plus one; requires `black_first`");
    visit.choice("event_model", patterns.event_model, capture::kEventModelNames,
                 "the event model: \"reference-aware\" (Eq. 9 and 10) or \"quantised\" (Eq. 8)");
    visit("codes", patterns.codes,
          "fixed patterns: those of a model, given by its file or [name](models.md#names), or a [JSON "
          "file](recordings.md#the-patterns), which `e2lf codes show -o codes.json` makes from other files");
    visit("start", patterns.start, "initial patterns, given likewise; may be fewer than `num_patterns`");
    visit("noise_start", patterns.noise_start,
          "if no patterns are given, initialises with white noise of this standard deviation instead of soft discs");
    visit("in_model", patterns.in_model,
          "whether the model contains the patterns; without them it can reconstruct, but not simulate");
    visit("begin_step", patterns.begin_step, "the patterns are fixed until this step");
    visit("learn_steps", patterns.learn_steps, "the patterns are learned until this step, then rounded to 0 or 1");
    visit("learning_rate", patterns.learning_rate, "learning rate of the patterns");
    visit("scale_begin", patterns.scale_begin, "initial s of sigmoid(s * parameter), which grows geometrically");
    visit("scale_end", patterns.scale_end, "final s");
  };
}

template <typename Sensor>
auto sensor_fields(Sensor& sensor) {
  return [&sensor](auto& visit) {
    visit("eps", sensor.nominal.eps, "dark level");
    visit("nominal_tau", sensor.nominal.tau, "nominal contrast threshold");
    visit("nominal_sigma_w", sensor.nominal.sigma_w, "nominal noise of the log intensity");
    visit("nominal_sigma_z", sensor.nominal.sigma_z, "nominal noise of the threshold");
    visit("sigma_i", sensor.nominal.sigma_i, "noise of intensity images, if `input` has any");
    visit("nominal_share", sensor.nominal_share, "share of samples with exactly the nominal constants");
    visit("noise_free_share", sensor.noise_free_share, "share of the other samples without noise");
    visit("residue_share", sensor.residue_share,
          "share of the samples that are not nominal with a residual reference offset");
    visit("tau", sensor.tau, "range");
    visit("sigma_w", sensor.sigma_w, "range");
    visit("sigma_z", sensor.sigma_z, "range");
    visit("full_gain_share", sensor.full_gain_share, "share of samples with gain 1");
    visit("gain", sensor.gain, "range of the gain of the others");
    visit("camera", sensor.camera,
          "a camera of the event model `pixel`, given by its file or [name](models.md#names); if empty, only the "
          "paper's model is used; requires `black_first`");
    visit("camera_share", sensor.camera_share, "share of samples with this camera");
    visit("camera_nominal_share", sensor.camera_nominal_share, "share of these with exactly the stated constants");
    visit("camera_spread", sensor.camera_spread, "the others vary within this multiple of the stated uncertainty");
    visit("camera_wide_share", sensor.camera_wide_share,
          "share of these with much faster pixels, or with less mismatch, noise and leakage, down to none");
    visit("camera_field_spread", sensor.camera_field_spread,
          "largest relative error of the transmission of a pattern, which the network does not receive");
    visit("camera_gain", sensor.camera_gain, "range of the gain of samples with this camera");
    visit("cycles_share", sensor.cycles_share,
          "share of steps whose samples with this camera are means over 2, 4, 8 or 16 cycles");
  };
}

template <typename Network>
auto network_fields(Network& network) {
  return [&network](auto& visit) {
    visit("type", network.type, "\"unet\", or \"recnet\" for the network of the paper");
    visit("widths", network.widths, "channels of each level");
    visit("blocks", network.blocks, "residual blocks of each level");
    visit("head_width", network.head_width,
          "channels at full resolution, 0 = no layers there, for networks that must be fast");
    visit("head_blocks", network.head_blocks, "residual blocks at full resolution");
  };
}

template <typename Train>
auto train_fields(Train& train) {
  return [&train](auto& visit) {
    visit("patch", train.patch, "height and width of a patch, px");
    visit("batch", train.batch, "samples per step");
    visit("steps", train.steps, "number of steps");
    visit("optimiser", train.optimiser,
          "\"muon\": Muon for all convolutions larger than 1x1 except the last, Adam for the rest; or \"adam\" for "
          "all. Gradients are centred in both cases");
    visit("learning_rate", train.learning_rate, "peak learning rate");
    visit("warmup_steps", train.warmup_steps, "steps of linear warm-up");
    visit("hold_steps", train.hold_steps,
          "step until which the rate stays at its peak; it then decreases to zero at `steps` as a cosine");
    visit("clip_norm", train.clip_norm, "norm at which the gradients are clipped");
    visit("ema", train.ema, "decay of the exponential moving average of the weights");
    visit("gain_weight_power", train.gain_weight_power,
          "the squared error of a sample is divided by its gain to this power");
    visit("error_power", train.error_power,
          "the result is raised to this power; the loss is the mean over the samples");
    visit("log_steps", train.log_steps, "steps between rows of `log.csv`");
    visit("evaluate_steps", train.evaluate_steps, "steps between evaluations");
    visit("checkpoint_steps", train.checkpoint_steps, "steps between checkpoints");
  };
}

template <typename AnyConfig, typename Visitor>
void visit_fields(AnyConfig& config, Visitor& visit) {
  visit("name", config.name, "name of the model and of its file");
  visit("seed", config.seed, "seed of all random numbers");
  visit("device", config.device, "`cpu`, or `cuda` or `cuda:1`, which have not been tried");
  visit("precision", config.precision,
        "`float32`, or `bfloat16` for convolutions in bfloat16 and master weights in float32, which is 1.5 times as "
        "fast on a CPU with AMX and far slower on one without bfloat16");
  visit("start", config.start,
        "a model that provides the initial weights, given by its file or [name](models.md#names)");
  visit.section("data", data_fields(config.data));
  visit.section("patterns", pattern_fields(config.patterns));
  visit.section("sensor", sensor_fields(config.sensor));
  visit.list("input", config.input, [](auto& group, auto& inner) {
    inner.choice("kind", group.kind, kInputKindNames,
                 "kind of an [input](#inputs); the inputs also determine the measurement, and the default is 0.125 x "
                 "counts, 0.125 x cumulative and, with `black_first`, 4 x intensity");
    inner("scale", group.scale, "factor on this input");
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
