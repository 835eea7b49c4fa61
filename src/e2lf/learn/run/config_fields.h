// SPDX-License-Identifier: MIT
#pragma once

#include <utility>

#include "e2lf/learn/run/config.h"

/// The one list of all fields of a configuration. Reading, writing and the table in docs/training.md go
/// through it.
///
/// visit(key, field, meaning) is called for each field, visit.section(key, list) for each object in the object, and
/// visit.choice(key, field, names, meaning) for an enum, whose values count the names.
namespace e2lf::learn {

inline constexpr const char* kEventModelNames[] = {"quantised", "reference-aware"};
inline constexpr const char* kInputKindNames[] = {"counts", "cumulative", "intensity", "camera",
                                                  "images", "image-sum",  "lens-array"};

template <typename Options>
auto synthesiser_fields(Options& options) {
  return [&options](auto& visit) {
    visit("size", options.size, "height and width, px");
    visit("max_disparity", options.max_disparity, "px per view, either sign");
    visit("max_layers", options.max_layers, "surfaces at most");
    visit("slant_share", options.slant_share, "surfaces whose disparity changes over the picture");
    visit("highlight_share", options.highlight_share, "scenes with reflections at a depth of their own");
    visit("procedural_share", options.procedural_share, "surfaces without a photograph");
  };
}

template <typename Data>
auto data_fields(Data& data) {
  return [&data](auto& visit) {
    visit("file", data.file, "made by `e2lf pack`; empty: procedural textures alone");
    visit("validation", data.validation,
          "scenes never trained on; they are evaluated. Without any, two light fields of the synthesiser are");
    visit("exclude", data.exclude, "scenes neither trained on nor evaluated");
    visit("synthetic_share", data.synthetic_share, "share of samples from the synthesiser");
    visit("patch_stride", data.patch_stride,
          "patches of light fields begin at multiples of this; 0: anywhere. BasicLFSR's protocol is 32 with patches of "
          "64");
    visit("pool", data.pool, "synthesised light fields kept");
    visit("pool_per_step", data.pool_per_step, "new ones per step");
    visit.section("synthesiser", synthesiser_fields(data.synthesiser));
  };
}

template <typename Patterns>
auto pattern_fields(Patterns& patterns) {
  return [&patterns](auto& visit) {
    visit("num_patterns", patterns.num_patterns, "");
    visit("black_first", patterns.black_first, "the first pattern is black");
    visit("complementary", patterns.complementary,
          "every second pattern is the inverse of the one before, so that all cells open equally long; not with "
          "`black_first`");
    visit(
        "whole_cycle", patterns.whole_cycle,
        "the codes, their inverses, and black again, as a display shows them; `num_patterns` is then twice the number "
        "of codes and one. Needs `black_first`");
    visit.choice("event_model", patterns.event_model, kEventModelNames, "Eq. 9 and 10; or \"quantised\", Eq. 8");
    visit("codes", patterns.codes,
          "patterns to use as they are: those of a model, by its file or [name](models.md#names), or "
          "[JSON](recordings.md#the-patterns) (`e2lf codes show -o codes.json` makes it of other files)");
    visit("start", patterns.start, "likewise, patterns that learning starts from; may be fewer than num_patterns");
    visit("noise_start", patterns.noise_start,
          "without any given: start from white noise of this width, in place of soft discs");
    visit("in_model", patterns.in_model,
          "false leaves the patterns out of the model: it reconstructs, but cannot simulate");
    visit("begin_step", patterns.begin_step, "patterns keep still until this step");
    visit("learn_steps", patterns.learn_steps, "then they move until this step and are rounded to 0 or 1");
    visit("learning_rate", patterns.learning_rate, "");
    visit("scale_begin", patterns.scale_begin, "s of sigmoid(s * parameter) grows geometrically from here");
    visit("scale_end", patterns.scale_end, "to here");
  };
}

template <typename Sensor>
auto sensor_fields(Sensor& sensor) {
  return [&sensor](auto& visit) {
    visit("eps", sensor.nominal.eps, "dark level");
    visit("nominal_tau", sensor.nominal.tau, "threshold");
    visit("nominal_sigma_w", sensor.nominal.sigma_w, "noise of the log intensity");
    visit("nominal_sigma_z", sensor.nominal.sigma_z, "noise of the threshold");
    visit("sigma_i", sensor.nominal.sigma_i, "noise of intensity images, where `input` has any");
    visit("nominal_share", sensor.nominal_share, "samples with exactly these");
    visit("noise_free_share", sensor.noise_free_share, "of the others: without noise");
    visit("residue_share", sensor.residue_share, "of those not nominal: references off black");
    visit("tau", sensor.tau, "range");
    visit("sigma_w", sensor.sigma_w, "range");
    visit("sigma_z", sensor.sigma_z, "range");
    visit("full_gain_share", sensor.full_gain_share, "samples with gain 1");
    visit("gain", sensor.gain, "range of the others");
    visit("camera", sensor.camera,
          "a camera of the event model `pixel`: a file, or the [name](models.md#names) of a bundled one; empty: the "
          "paper's model alone. Needs `black_first`");
    visit("camera_share", sensor.camera_share, "samples with that camera");
    visit("camera_nominal_share", sensor.camera_nominal_share, "of these: exactly the stated constants");
    visit("camera_spread", sensor.camera_spread, "the others vary over so many times the stated uncertainty");
    visit("camera_wide_share", sensor.camera_wide_share,
          "of these: much faster pixels, or less mismatch, noise and leakage down to none");
    visit("camera_field_spread", sensor.camera_field_spread,
          "what a pattern passes differs from the told value by up to this share; the network is not told");
    visit("camera_gain", sensor.camera_gain, "range of the gain of these");
    visit("cycles_share", sensor.cycles_share, "steps whose camera samples are means over 2, 4, 8 or 16 cycles");
  };
}

template <typename Network>
auto network_fields(Network& network) {
  return [&network](auto& visit) {
    visit("type", network.type, "or \"recnet\", the paper's");
    visit("widths", network.widths, "channels of each level");
    visit("blocks", network.blocks, "residual blocks of each level");
    visit("head_width", network.head_width, "channels at full resolution");
    visit("head_blocks", network.head_blocks, "residual blocks at full resolution");
  };
}

template <typename Train>
auto train_fields(Train& train) {
  return [&train](auto& visit) {
    visit("patch", train.patch, "px");
    visit("batch", train.batch, "samples per step");
    visit("steps", train.steps, "");
    visit("optimiser", train.optimiser,
          "Muon for convolutions larger than 1x1 but the last, Adam for the rest; or \"adam\" for all. Gradients are "
          "centred for both");
    visit("learning_rate", train.learning_rate, "at its peak");
    visit("warmup_steps", train.warmup_steps, "the rate rises");
    visit("hold_steps", train.hold_steps, "it stays at its peak until here, then falls to zero at `steps` as a cosine");
    visit("clip_norm", train.clip_norm, "gradients are clipped at this norm");
    visit("ema", train.ema, "decay of the averaged weights");
    visit("gain_weight_power", train.gain_weight_power,
          "a sample's squared error is divided by its gain to this power");
    visit("error_power", train.error_power, "then raised to this; the loss is the mean");
    visit("log_steps", train.log_steps, "steps between rows of `log.csv`");
    visit("evaluate_steps", train.evaluate_steps, "between evaluations");
    visit("checkpoint_steps", train.checkpoint_steps, "between checkpoints");
  };
}

template <typename AnyConfig, typename Visitor>
void visit_fields(AnyConfig& config, Visitor& visit) {
  visit("name", config.name, "name of the model and its file");
  visit("seed", config.seed, "of everything random");
  visit("device", config.device, "or `cuda`, `cuda:1` (untried)");
  visit("precision", config.precision,
        "or `bfloat16`: convolutions in bfloat16, master weights in float32. 1.5 times as fast on a CPU with AMX, far "
        "slower on one without bfloat16");
  visit("start", config.start,
        "a model to start the weights from: a file, or the [name](models.md#names) of a bundled one");
  visit.section("data", data_fields(config.data));
  visit.section("patterns", pattern_fields(config.patterns));
  visit.section("sensor", sensor_fields(config.sensor));
  visit.inputs("input", config.input,
               "see [inputs](#inputs), which say what is measured; the intensity only with `black_first`");
  visit.section("network", network_fields(config.network));
  visit.section("train", train_fields(config.train));
}

}  // namespace e2lf::learn
