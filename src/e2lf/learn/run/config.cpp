// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/config.h"

#include <algorithm>

#include "e2lf/base/text.h"
#include "e2lf/learn/network/any_patterns.h"

namespace e2lf::learn {
namespace {

// The fields of a configuration, which docs/training.md describes; see files/options.h.

template <typename AnyConfig, typename Visitor>
void visit_fields(AnyConfig& config, Visitor& visit) {
  E2LF_VISIT(config, visit, name, seed, device, precision, start);
  visit.section("data", [&data = config.data](auto& inner) {
    E2LF_VISIT(data, inner, file, validation, exclude, synthetic_share, patch_stride, pool, pool_per_step);
    inner.section("synthesiser", [&data](auto& innermost) {
      E2LF_VISIT(data.synthesiser, innermost, size, max_disparity, max_layers, slant_share, highlight_share,
                 procedural_share, motion_px_per_cycle, still_share);
    });
  });
  visit.section("patterns", [&patterns = config.patterns](auto& inner) {
    E2LF_VISIT(patterns, inner, num_patterns, black_first, complementary, whole_cycle);
    inner.choice("event_model", patterns.event_model, capture::kEventModels);
    E2LF_VISIT(patterns, inner, codes, start, drawn, known, evaluated, noise_start, in_model, begin_step, learn_steps,
               learning_rate, scale_begin, scale_end);
  });
  visit.section("sensor", [&sensor = config.sensor](auto& inner) {
    inner("eps", sensor.nominal.eps);
    inner("nominal_tau", sensor.nominal.tau);
    inner("nominal_sigma_w", sensor.nominal.sigma_w);
    inner("nominal_sigma_z", sensor.nominal.sigma_z);
    inner("sigma_i", sensor.nominal.sigma_i);
    E2LF_VISIT(sensor, inner, nominal_share, noise_free_share, residue_share, tau, sigma_w, sigma_z, full_gain_share,
               gain, camera, camera_share, camera_nominal_share, camera_spread, camera_wide_share, camera_field_spread,
               camera_gain, cycles_share);
  });
  visit.list("input", config.input, [](auto& group, auto& inner) {
    inner.choice("kind", group.kind, model::kInputKinds);
    inner("scale", group.scale);
  });
  visit.section("network", [&network = config.network](auto& inner) {
    E2LF_VISIT(network, inner, type, widths, blocks, head_width, head_blocks, share_of_full_scale, disparity,
               weak_texture);
  });
  visit.section("train", [&train = config.train](auto& inner) {
    E2LF_VISIT(train, inner, patch, batch, steps, optimiser, adam_decay, centred, learning_rate, warmup_steps,
               hold_steps, clip_norm, ema, gain_weight_power, error_power, log_steps, evaluate_steps, checkpoint_steps);
  });
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
  if (network.type != "unet" && network.type != "recnet" && !network.gives_disparity()) {
    return invalid(cat("unknown network type \"", network.type, "\"; use unet, recnet or plane-sweep"), location);
  }
  if (network.widths.empty() || network.widths.size() != network.blocks.size()) {
    return invalid("widths and blocks need one entry per level; make the lists equally long", location);
  }
  return {};
}

/// Checks a network for any patterns, whose inputs and samples are not those of a network of views.
Result<void> check_any_patterns(const Config& config, const std::string& location) {
  using model::InputKind;
  const bool reads_moved = config.reads_moved_pictures();
  const std::string type = reads_moved ? "a network of moved pictures" : config.network.type;
#if !E2LF_LEARN_KERNELS
  return fail(ErrorCode::kMissingDependency, location + ".network.type",
              "this program was built without the operations of geometry; train with e2lf");
#endif
  constexpr InputKind kKinds[] = {InputKind::kCumulative, InputKind::kLevel, InputKind::kIntensity, InputKind::kCamera};
  if (!reads_moved && !std::ranges::equal(config.input, kKinds, {}, &model::InputGroup::kind)) {
    return invalid("the inputs of plane-sweep are cumulative, level, intensity and camera; list these, or moved alone",
                   location + ".input");
  }
  if (config.patterns.codes.empty() || !config.patterns.black_first) {
    return invalid(cat(type, " needs the patterns of patterns.codes; name a set whose first pattern is black"),
                   location + ".patterns.codes");
  }
  if (reads_moved && config.patterns.whole_cycle) {
    return invalid("moved pictures are those of the transitions of the lit patterns; set whole_cycle to false",
                   location + ".patterns.whole_cycle");
  }
  const size_t multiple = size_t{2} << (config.network.widths.size() - 1);
  if (config.network.widths.size() < 2 || config.train.patch % multiple != 0) {
    return invalid(cat(type, " needs two levels or more, and patches of a multiple of ", multiple,
                       " px for these levels; set train.patch to one"),
                   location + ".train.patch");
  }
  if (config.network.gives_disparity() && config.data.synthesiser.size != static_cast<int64_t>(config.train.patch)) {
    return invalid("plane-sweep is trained with whole scenes; set train.patch and data.synthesiser.size to one value",
                   location + ".train.patch");
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
  OptionReader reader(json, location);
  visit_fields(config, reader);
  E2LF_RETURN_IF_ERROR(reader.finish());
  if (!is_black_first && std::any_of(config.input.begin(), config.input.end(), is_intensity)) {
    return invalid("intensity inputs need a black first pattern; leave them out or set patterns.black_first",
                   location + ".input");
  }
  const auto is_moved = [](const model::InputGroup& group) { return group.kind == model::InputKind::kMoved; };
  if (config.input.size() > 1 && std::any_of(config.input.begin(), config.input.end(), is_moved)) {
    return invalid("the input moved contains all others; list it alone", location + ".input");
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
  if (config.network.gives_disparity() || config.reads_moved_pictures()) {
    E2LF_RETURN_IF_ERROR(check_any_patterns(config, location));
  }
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
  model::UnetOptions options = config.network;
  options.input_channels = model::num_input_channels(config.input, config.patterns.num_patterns);
#if E2LF_LEARN_KERNELS
  if (config.network.gives_disparity()) {
    return config.reads_moved_pictures() ? depth_network_of_moved_pictures(config.network.widths)
                                         : depth_network(config.network.widths, options.input_channels);
  }
#endif
  return config.network.type == "recnet" ? model::recnet(options.input_channels) : model::unet(options);
}

}  // namespace e2lf::learn
