// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "e2lf/files/options.h"
#include "e2lf/learn/data/synthesiser.h"
#include "e2lf/learn/events/event_simulation.h"
#include "e2lf/model/model.h"

namespace e2lf::learn {

struct DataConfig {
  std::string file;                     ///< made by `e2lf pack`; empty: procedural textures alone
  std::vector<std::string> validation;  ///< light fields for evaluation, never trained on; empty: synthesised ones
  std::vector<std::string> exclude;     ///< light fields neither trained on nor evaluated during training
  double synthetic_share = 0.5;         ///< share of samples from the synthesiser
  uint64_t patch_stride = 0;            ///< patches of light fields lie on a grid from the top left; 0 = anywhere
  uint64_t pool = 256;                  ///< synthesised light fields kept; each gives several crops
  double pool_per_step = 1.0;           ///< new ones made per step
  SynthesiserOptions synthesiser;
};

struct PatternConfig {
  uint64_t num_patterns = 4;
  bool black_first = true;
  bool complementary = false;  ///< every second pattern is the inverse of the one before; not with black_first
  bool whole_cycle = false;    ///< codes, their inverses, and black again: num_patterns is twice their number and one
  EventModel event_model = EventModel::kReferenceAware;
  std::string codes;            ///< a model (file or name) or codes as JSON, to use as they are; empty: learn them
  std::string start;            ///< likewise, codes that learning starts from; empty: at random
  double noise_start = 0.0;     ///< at random: parameters are white noise of this width; 0 = soft discs
  bool in_model = true;         ///< the model holds the codes; without them it reconstructs but does not simulate
  uint64_t begin_step = 200;    ///< patterns keep still until here, while the network learns to use them
  uint64_t learn_steps = 2000;  ///< steps until learned patterns are rounded to 0/1 and kept
  double learning_rate = 1e-3;
  double scale_begin = 4.0, scale_end = 60.0;  ///< s of sigmoid(s * parameter), growing geometrically

  /// How many codes there are: the patterns, or in a whole cycle those before the inverses.
  [[nodiscard]] uint64_t num_codes() const { return whole_cycle ? (num_patterns - 1) / 2 : num_patterns; }
};

/// What varies between samples, so that one model serves many cameras and scenes.
struct SensorConfig {
  capture::SensorConstants nominal;
  double nominal_share = 0.4;      ///< share of samples with exactly the nominal tau, sigma_w, sigma_z
  double noise_free_share = 0.15;  ///< of the others: share with sigma_w = sigma_z = 0
  double residue_share = 0.0;      ///< of the not nominal: share with references a part of a threshold too high
  std::array<double, 2> tau = {0.27, 0.33};  ///< uniform; known to the network through its inputs
  std::array<double, 2> sigma_w = {0.0, 0.25};
  std::array<double, 2> sigma_z = {0.0, 0.06};
  std::string camera;                 ///< a camera (file or name) of the model "pixel"; empty: the paper's model alone
  double camera_share = 0.5;          ///< share of samples with that camera
  double camera_nominal_share = 0.3;  ///< of these: share with exactly the stated constants
  double camera_spread = 1.0;         ///< the others vary over so many times the stated uncertainty
  double camera_wide_share = 0.0;     ///< of these: share far from the stated one; draw_wide() has the ranges
  double camera_field_spread = 0.0;   ///< transmissions are off by up to this share, which the network is not told
  std::array<double, 2> camera_gain = {0.15, 1.4};  ///< log-uniform factor on the light field of these
  double cycles_share = 0.0;     ///< share of steps whose camera samples are means over 2, 4, 8 or 16 cycles
  double full_gain_share = 0.5;  ///< share of samples with gain 1
  std::array<double, 2> gain = {0.15, 1.0};  ///< log-uniform factor on the light field
};

struct NetworkConfig {
  std::string type = "unet";  ///< "unet" or "recnet"
  std::vector<uint64_t> widths = {80, 96, 128};
  std::vector<uint64_t> blocks = {2, 2, 2};
  uint64_t head_width = 32, head_blocks = 0;
};

struct TrainConfig {
  uint64_t patch = 64, batch = 16, steps = 20000;
  std::string optimiser = "muon";  ///< or "adam" for all weights; see muon.h
  double learning_rate = 1e-3;
  uint64_t warmup_steps = 200;
  uint64_t hold_steps = 0;  ///< the rate stays at its peak until here, then follows a cosine to zero
  double clip_norm = 0.1;   ///< usual norms are 0.005 to 0.05; a rare large one would throw Adam off
  double ema = 0.999;
  double gain_weight_power = 1.0;  ///< a sample's squared error is divided by its gain to this power
  double error_power = 1.0;        ///< then raised to this: below 1, hard samples do not drown the others
  uint64_t log_steps = 50, evaluate_steps = 1000, checkpoint_steps = 250;
};

/// Everything that defines a training run; see docs/training.md for the JSON keys.
struct Config {
  std::string name = "model";
  uint64_t seed = 1;
  std::string device = "cpu";         ///< "cpu", "cuda", "cuda:1"
  std::string precision = "float32";  ///< or "bfloat16": of the network's convolutions
  std::string start;                  ///< a model (file or name) whose weights training starts from; empty: random
  DataConfig data;
  PatternConfig patterns;
  SensorConfig sensor;
  std::vector<model::InputGroup> input = {{model::InputKind::kCounts, 0.125F},
                                          {model::InputKind::kCumulative, 0.125F},
                                          {model::InputKind::kIntensity, 4.0F}};
  NetworkConfig network;
  TrainConfig train;
};

/// Reads a configuration; absent keys keep their defaults. Fails with kInvalidValue on an unknown key (naming the
/// nearest), a wrong type or a value out of range.
[[nodiscard]] Result<Config> config_from_json(const Json& json, const std::string& location);

/// All fields, so that a run's folder tells what was done. config_from_json reads it back.
[[nodiscard]] Json to_json(const Config& config);

/// All fields with their defaults and meanings, as rows of a Markdown table: that of docs/training.md.
[[nodiscard]] std::string config_table();

/// The network that a configuration describes.
[[nodiscard]] model::Network make_network(const Config& config);

}  // namespace e2lf::learn
