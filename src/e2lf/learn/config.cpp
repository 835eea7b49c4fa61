// SPDX-License-Identifier: MIT
#include "e2lf/learn/config.h"

#include <algorithm>

#include "e2lf/model/unet.h"

namespace e2lf::learn {
namespace {

constexpr const char* kEventModels[] = {"quantised", "reference-aware"};
constexpr const char* kInputKinds[] = {"counts", "cumulative", "intensity", "camera"};

Error invalid(const std::string& message, const std::string& location) {
  return Error{ErrorCode::kInvalidValue, message, location};
}

Result<void> read_data(OptionReader reader, DataConfig& data) {
  reader.read("file", data.file).read("validation", data.validation).read("exclude", data.exclude);
  reader.read("synthetic_share", data.synthetic_share).read("pool", data.pool);
  reader.read("pool_per_step", data.pool_per_step).read("patch_stride", data.patch_stride);
  OptionReader synth(reader.child("synthesiser"), reader.child_location("synthesiser"));
  synth.read("size", data.synthesiser.size).read("max_disparity", data.synthesiser.max_disparity);
  synth.read("max_layers", data.synthesiser.max_layers).read("slant_share", data.synthesiser.slant_share);
  synth.read("highlight_share", data.synthesiser.highlight_share);
  synth.read("procedural_share", data.synthesiser.procedural_share);
  E2LF_RETURN_IF_ERROR(synth.finish());
  return reader.finish();
}

Result<void> read_patterns(OptionReader reader, const std::string& location, PatternConfig& patterns) {
  std::string event_model = kEventModels[static_cast<size_t>(patterns.event_model)];
  reader.read("num_patterns", patterns.num_patterns).read("black_first", patterns.black_first);
  reader.read("event_model", event_model).read("codes", patterns.codes).read("learn_steps", patterns.learn_steps);
  reader.read("start", patterns.start).read("in_model", patterns.in_model);
  reader.read("complementary", patterns.complementary).read("noise_start", patterns.noise_start);
  reader.read("begin_step", patterns.begin_step).read("learning_rate", patterns.learning_rate);
  reader.read("scale_begin", patterns.scale_begin).read("scale_end", patterns.scale_end);
  E2LF_RETURN_IF_ERROR(reader.finish());
  if (event_model != kEventModels[0] && event_model != kEventModels[1]) {
    return invalid("event_model is \"quantised\" or \"reference-aware\"; write one of them", location);
  }
  patterns.event_model = event_model == kEventModels[0] ? EventModel::kQuantised : EventModel::kReferenceAware;
  if (patterns.complementary && (patterns.black_first || patterns.num_patterns % 2 != 0)) {
    return invalid(
        "complementary patterns come in pairs, none of them black; set black_first to false and an even "
        "num_patterns",
        location);
  }
  if (patterns.num_patterns < 2) return invalid("num_patterns must be at least 2; raise it", location);
  return {};
}

Result<void> read_sensor(OptionReader reader, SensorConfig& sensor) {
  reader.read("eps", sensor.nominal.eps).read("nominal_tau", sensor.nominal.tau);
  reader.read("nominal_sigma_w", sensor.nominal.sigma_w).read("nominal_sigma_z", sensor.nominal.sigma_z);
  reader.read("noise_free_share", sensor.noise_free_share).read("residue_share", sensor.residue_share);
  reader.read("nominal_share", sensor.nominal_share).read("tau", sensor.tau).read("sigma_w", sensor.sigma_w);
  reader.read("camera", sensor.camera).read("camera_share", sensor.camera_share);
  reader.read("camera_nominal_share", sensor.camera_nominal_share).read("camera_spread", sensor.camera_spread);
  reader.read("camera_field_spread", sensor.camera_field_spread);
  reader.read("camera_gain", sensor.camera_gain).read("cycles_share", sensor.cycles_share);
  reader.read("sigma_z", sensor.sigma_z).read("full_gain_share", sensor.full_gain_share).read("gain", sensor.gain);
  return reader.finish();
}

Result<void> read_input(const Json& json, const std::string& location, std::vector<model::InputGroup>& input) {
  if (json.is_null()) return {};
  if (!json.is_array() || json.empty()) return invalid("input is a list of objects; see docs/training.md", location);
  input.clear();
  for (const Json& item : json) {
    std::string kind;
    model::InputGroup group;
    OptionReader reader(item, location);
    reader.read("kind", kind).read("scale", group.scale);
    E2LF_RETURN_IF_ERROR(reader.finish());
    const auto* const found = std::find(std::begin(kInputKinds), std::end(kInputKinds), kind);
    if (found == std::end(kInputKinds)) {
      return invalid(cat("unknown kind \"", kind, "\"; use counts, cumulative, intensity or camera"), location);
    }
    group.kind = static_cast<model::InputKind>(found - std::begin(kInputKinds));
    input.push_back(group);
  }
  return {};
}

bool is_intensity(const model::InputGroup& group) {
  return group.kind == model::InputKind::kIntensity;
}

Result<void> read_network(OptionReader reader, const std::string& location, NetworkConfig& network) {
  reader.read("type", network.type).read("widths", network.widths).read("blocks", network.blocks);
  reader.read("head_width", network.head_width).read("head_blocks", network.head_blocks);
  E2LF_RETURN_IF_ERROR(reader.finish());
  if (network.type != "unet" && network.type != "recnet") {
    return invalid(cat("unknown network type \"", network.type, "\"; use unet or recnet"), location);
  }
  if (network.widths.empty() || network.widths.size() != network.blocks.size()) {
    return invalid("widths and blocks need one entry per level; make the lists equally long", location);
  }
  return {};
}

Result<void> read_train(OptionReader reader, const std::string& location, TrainConfig& train) {
  reader.read("patch", train.patch).read("batch", train.batch).read("steps", train.steps);
  reader.read("optimiser", train.optimiser);
  reader.read("learning_rate", train.learning_rate).read("warmup_steps", train.warmup_steps);
  reader.read("hold_steps", train.hold_steps).read("clip_norm", train.clip_norm).read("ema", train.ema);
  reader.read("gain_weight_power", train.gain_weight_power).read("error_power", train.error_power);
  reader.read("log_steps", train.log_steps);
  reader.read("evaluate_steps", train.evaluate_steps).read("checkpoint_steps", train.checkpoint_steps);
  E2LF_RETURN_IF_ERROR(reader.finish());
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
  OptionReader reader(json, location);
  reader.read("name", config.name).read("seed", config.seed).read("device", config.device);
  reader.read("precision", config.precision).read("start", config.start);
  const auto at = [&](const char* key) { return reader.child_location(key); };
  E2LF_RETURN_IF_ERROR(read_data(OptionReader(reader.child("data"), at("data")), config.data));
  E2LF_RETURN_IF_ERROR(
      read_patterns(OptionReader(reader.child("patterns"), at("patterns")), at("patterns"), config.patterns));
  E2LF_RETURN_IF_ERROR(read_sensor(OptionReader(reader.child("sensor"), at("sensor")), config.sensor));
  // Without darkness first, counts tell changes of the intensity but not the intensity.
  if (!config.patterns.black_first) std::erase_if(config.input, is_intensity);
  E2LF_RETURN_IF_ERROR(read_input(reader.child("input"), at("input"), config.input));
  if (!config.patterns.black_first && std::any_of(config.input.begin(), config.input.end(), is_intensity)) {
    return invalid("intensity inputs need a black first pattern; leave them out or set patterns.black_first",
                   at("input"));
  }
  E2LF_RETURN_IF_ERROR(
      read_network(OptionReader(reader.child("network"), at("network")), at("network"), config.network));
  E2LF_RETURN_IF_ERROR(read_train(OptionReader(reader.child("train"), at("train")), at("train"), config.train));
  E2LF_RETURN_IF_ERROR(reader.finish());
  if (config.precision != "float32" && config.precision != "bfloat16") {
    return invalid("precision is \"float32\" or \"bfloat16\"; write one of them", at("precision"));
  }
  if (config.data.synthesiser.size < static_cast<int64_t>(config.train.patch)) {
    return invalid("synthesised light fields are smaller than a patch; raise data.synthesiser.size", at("train.patch"));
  }
  return config;
}

Json to_json(const Config& config) {
  const auto& [file, validation, exclude, synthetic_share, patch_stride, pool, pool_per_step, synth] = config.data;
  const PatternConfig& patterns = config.patterns;
  const SensorConfig& sensor = config.sensor;
  const TrainConfig& train = config.train;
  Json input = Json::array();
  for (const auto& group : config.input) {
    input.push_back({{"kind", kInputKinds[static_cast<size_t>(group.kind)]}, {"scale", group.scale}});
  }
  return {{"name", config.name},
          {"seed", config.seed},
          {"device", config.device},
          {"precision", config.precision},
          {"start", config.start},
          {"data",
           {{"file", file},
            {"validation", validation},
            {"exclude", exclude},
            {"synthetic_share", synthetic_share},
            {"patch_stride", patch_stride},
            {"pool", pool},
            {"pool_per_step", pool_per_step},
            {"synthesiser",
             {{"size", synth.size},
              {"max_disparity", synth.max_disparity},
              {"max_layers", synth.max_layers},
              {"slant_share", synth.slant_share},
              {"highlight_share", synth.highlight_share},
              {"procedural_share", synth.procedural_share}}}}},
          {"patterns",
           {{"num_patterns", patterns.num_patterns},
            {"black_first", patterns.black_first},
            {"complementary", patterns.complementary},
            {"event_model", kEventModels[static_cast<size_t>(patterns.event_model)]},
            {"codes", patterns.codes},
            {"start", patterns.start},
            {"noise_start", patterns.noise_start},
            {"in_model", patterns.in_model},
            {"begin_step", patterns.begin_step},
            {"learn_steps", patterns.learn_steps},
            {"learning_rate", patterns.learning_rate},
            {"scale_begin", patterns.scale_begin},
            {"scale_end", patterns.scale_end}}},
          {"sensor",
           {{"eps", sensor.nominal.eps},
            {"nominal_tau", sensor.nominal.tau},
            {"nominal_sigma_w", sensor.nominal.sigma_w},
            {"nominal_sigma_z", sensor.nominal.sigma_z},
            {"nominal_share", sensor.nominal_share},
            {"noise_free_share", sensor.noise_free_share},
            {"residue_share", sensor.residue_share},
            {"tau", sensor.tau},
            {"sigma_w", sensor.sigma_w},
            {"sigma_z", sensor.sigma_z},
            {"camera", sensor.camera},
            {"camera_share", sensor.camera_share},
            {"camera_nominal_share", sensor.camera_nominal_share},
            {"camera_spread", sensor.camera_spread},
            {"camera_field_spread", sensor.camera_field_spread},
            {"camera_gain", sensor.camera_gain},
            {"cycles_share", sensor.cycles_share},
            {"full_gain_share", sensor.full_gain_share},
            {"gain", sensor.gain}}},
          {"input", input},
          {"network",
           {{"type", config.network.type},
            {"widths", config.network.widths},
            {"blocks", config.network.blocks},
            {"head_width", config.network.head_width},
            {"head_blocks", config.network.head_blocks}}},
          {"train",
           {{"patch", train.patch},
            {"batch", train.batch},
            {"steps", train.steps},
            {"optimiser", train.optimiser},
            {"learning_rate", train.learning_rate},
            {"warmup_steps", train.warmup_steps},
            {"hold_steps", train.hold_steps},
            {"clip_norm", train.clip_norm},
            {"ema", train.ema},
            {"gain_weight_power", train.gain_weight_power},
            {"error_power", train.error_power},
            {"log_steps", train.log_steps},
            {"evaluate_steps", train.evaluate_steps},
            {"checkpoint_steps", train.checkpoint_steps}}}};
}

model::Network make_network(const Config& config) {
  const size_t channels = model::num_input_channels(config.input, config.patterns.num_patterns);
  if (config.network.type == "recnet") return model::recnet(channels);
  return model::unet({.input_channels = channels,
                      .widths = {config.network.widths.begin(), config.network.widths.end()},
                      .blocks = {config.network.blocks.begin(), config.network.blocks.end()},
                      .head_width = config.network.head_width,
                      .head_blocks = config.network.head_blocks});
}

}  // namespace e2lf::learn
