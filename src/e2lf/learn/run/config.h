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
  std::string file;                     ///< made by `e2lf pack`; if empty, only procedural textures are used
  std::vector<std::string> validation;  ///< scenes for evaluation, never used for training; if empty, synthesised
  std::vector<std::string> exclude;     ///< light fields neither trained on nor evaluated during training
  double synthetic_share = 0.5;         ///< share of samples from the synthesiser
  uint64_t patch_stride = 0;            ///< patches begin at multiples of this; 0 = anywhere
  uint64_t pool = 256;                  ///< number of synthesised light fields that are kept
  double pool_per_step = 1.0;           ///< number of them that are replaced per step
  SynthesiserOptions synthesiser;
};

struct PatternConfig {
  uint64_t num_patterns = 4;
  bool black_first = true;
  bool complementary = false;  ///< every second pattern is the inverse of the one before; excludes black_first
  bool whole_cycle = false;    ///< codes, inverses and black again: num_patterns is twice their number plus one
  EventModel event_model = EventModel::kReferenceAware;
  std::string codes;  ///< fixed patterns: a model (file or name) or a JSON file; if empty, they are learned
  std::string start;  ///< initial patterns, likewise; if empty, they are random
  bool drawn = true;  ///< of networks for any patterns: whether samples have patterns of their own, or all have `codes`
  std::vector<std::string> known;      ///< of these: sets of which some of the drawn ones are taken
  std::vector<std::string> evaluated;  ///< of these: sets with which evaluations are made; if empty, `codes`
  double noise_start = 0.0;            ///< standard deviation of random initial parameters; 0 = soft discs instead
  bool in_model = true;                ///< whether the model contains the patterns; without them it cannot simulate
  uint64_t begin_step = 200;           ///< patterns are fixed until this step, while the network learns to use them
  uint64_t learn_steps = 2000;         ///< step at which learned patterns are rounded to 0 or 1 and fixed
  double learning_rate = 1e-3;
  double scale_begin = 4.0, scale_end = 60.0;  ///< s of sigmoid(s * parameter), which grows geometrically

  /// Returns the number of codes: all patterns, or for a whole cycle those before the inverses.
  [[nodiscard]] uint64_t num_codes() const { return whole_cycle ? (num_patterns - 1) / 2 : num_patterns; }
};

/// The distribution of conditions over the samples, so that one model serves many cameras and scenes.
struct SensorConfig {
  capture::SensorConstants nominal;
  double nominal_share = 0.4;      ///< share of samples with exactly the nominal tau, sigma_w, sigma_z
  double noise_free_share = 0.15;  ///< share of the other samples with sigma_w = sigma_z = 0
  double residue_share = 0.0;      ///< share of the samples that are not nominal with a residual reference offset
  std::array<double, 2> tau = {0.27, 0.33};  ///< uniform; the network receives it through its inputs
  std::array<double, 2> sigma_w = {0.0, 0.25};
  std::array<double, 2> sigma_z = {0.0, 0.06};
  std::string camera;         ///< a camera (file or name) of the model "pixel"; if empty, only the paper's model
  double camera_share = 0.5;  ///< share of samples with this camera
  double camera_nominal_share = 0.3;  ///< share of these with exactly the stated constants
  double camera_spread = 1.0;         ///< the others vary within this multiple of the stated uncertainty
  double camera_wide_share = 0.0;     ///< share of these with reduced imperfections; see draw_wide()
  double camera_field_spread = 0.0;   ///< largest relative error of a transmission, unknown to the network
  std::array<double, 2> camera_gain = {0.15, 1.4};  ///< log-uniform range of the gain of samples with this camera
  double cycles_share = 0.0;     ///< share of steps whose camera samples are means over 2, 4, 8 or 16 cycles
  double full_gain_share = 0.5;  ///< share of samples with gain 1
  std::array<double, 2> gain = {0.15, 1.0};  ///< log-uniform range of the gain of the others
};

/// The numbers of channels at both ends follow from the inputs and the views.
struct NetworkConfig : model::UnetOptions {
  std::string type = "unet";  ///< "unet", "recnet", or for any patterns "plane-sweep" (disparity instead of views)
  double share_of_full_scale = 0.65;  ///< of "plane-sweep" on events in its model file; see model::at_two_scales()
  std::string disparity =
      "e2lf-depth-first";      ///< the model that moves the pictures of the input "moved", which is not trained
  double weak_texture = 0.01;  ///< of views of moved pictures in their model file; see model::Guide::weak_texture

  [[nodiscard]] bool gives_disparity() const { return type == "plane-sweep"; }
};

struct TrainConfig {
  uint64_t patch = 64, batch = 16, steps = 20000;
  std::string optimiser = "muon";  ///< "muon", or "adam" for all weights; see muon.h
  double adam_decay = 0.999;       ///< of Adam's second moments
  bool centred = true;             ///< whether gradients are centred; see optimisers.h
  double learning_rate = 1e-3;
  uint64_t warmup_steps = 200;
  uint64_t hold_steps = 0;  ///< the rate stays at its peak until this step, then decreases to zero as a cosine
  double clip_norm = 0.1;   ///< typical norms are 0.005 to 0.05; a rare large one would disturb Adam for long
  double ema = 0.999;
  double gain_weight_power = 1.0;  ///< the squared error of a sample is divided by its gain to this power
  double error_power = 1.0;        ///< then raised to this power; below 1, the hardest samples dominate less
  uint64_t log_steps = 50, evaluate_steps = 1000, checkpoint_steps = 250;
};

/// The complete definition of a training run; docs/training.md describes the JSON keys.
struct Config {
  std::string name = "model";
  uint64_t seed = 1;
  std::string device = "cpu";         ///< "cpu", "cuda", "cuda:1"
  std::string precision = "float32";  ///< "float32" or "bfloat16", for the convolutions of the network
  std::string start;  ///< a model (file or name) that provides the initial weights; if empty, they are random
  DataConfig data;
  PatternConfig patterns;
  SensorConfig sensor;
  std::vector<model::InputGroup> input = {{model::InputKind::kCounts, 0.125F},
                                          {model::InputKind::kCumulative, 0.125F},
                                          {model::InputKind::kIntensity, 4.0F}};
  NetworkConfig network;
  TrainConfig train;

  /// Whether the views are those of any patterns.
  [[nodiscard]] bool reads_moved_pictures() const {
    return input.size() == 1 && input[0].kind == model::InputKind::kMoved;
  }
};

/// Reads a configuration. Absent keys keep their defaults. Fails with kInvalidValue (an unknown key, for which the
/// nearest one is suggested, a wrong type, or a value out of range).
[[nodiscard]] Result<Config> config_from_json(const Json& json, const std::string& location);

/// Returns all fields as JSON, so that the folder of a run documents it. config_from_json() reads them.
[[nodiscard]] Json to_json(const Config& config);

/// Returns the network that a configuration describes.
[[nodiscard]] model::Network make_network(const Config& config);

}  // namespace e2lf::learn
