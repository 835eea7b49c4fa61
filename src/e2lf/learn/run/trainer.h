// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/learn/data/batches.h"
#include "e2lf/learn/optimisers/adam.h"
#include "e2lf/learn/optimisers/muon.h"
#include "e2lf/learn/run/config.h"
#include "e2lf/learn/run/evaluate.h"
#include "e2lf/learn/run/gradient_exchange.h"
#include "e2lf/learn/run/peers.h"
#include "e2lf/learn/run/run_log.h"

namespace e2lf::learn {

/// What one step of training did.
struct StepReport {
  double loss = 0;           ///< what the gradient is of
  double mse = 0;            ///< plain mean squared error
  double gradient_norm = 0;  ///< before clipping
};

/// Joint training of patterns and network. Everything that changes between steps is in the checkpoint, and what a step
/// draws depends on the seed and its number alone: a resumed run continues bit-exactly on the same machine.
class Trainer {
 public:
  /// Reads the data and prepares step 0. Fails as read_dataset, Batches::create and (for `start` and `codes`)
  /// read_model, and with kInvalidValue when the batch cannot be split evenly between the peers.
  [[nodiscard]] static Result<Trainer> create(const Config& config, const Peers& peers = {});

  /// Trains until config.train.steps, from wherever the first peer is. The folder gets config.json, log.csv,
  /// evaluation.csv and checkpoint.safetensors, all written by the first peer. `keep_going` is asked after each step:
  /// false in any process stops all with a checkpoint and kCancelled. Fails with kInvalidValue when the loss is no
  /// longer finite and kIo when a peer is lost; the last good checkpoint stays.
  [[nodiscard]] Result<void> run(const std::filesystem::path& folder, const ProgressFn& progress = {},
                                 const std::function<bool()>& keep_going = {});

  /// One step without logs or files. Fails with kIo when a peer is lost.
  [[nodiscard]] Result<StepReport> train_step();

  [[nodiscard]] Result<void> save_checkpoint(const std::filesystem::path& path) const;
  [[nodiscard]] Result<void> load_checkpoint(const std::filesystem::path& path);

  /// Scores of the averaged weights on the named scenes, recorded by a camera over so many cycles.
  [[nodiscard]] Result<std::vector<SceneScore>> evaluate(const std::vector<std::string>& scenes,
                                                         const capture::SensorProfile& camera, size_t cycles = 1) const;

  /// The cameras that evaluations are made with: the paper's at its nominal constants, and sensor.camera.
  [[nodiscard]] std::vector<capture::SensorProfile> cameras() const;

  /// The averaged weights and the patterns as a model. Patterns still being learned are rounded to 0 and 1.
  [[nodiscard]] model::Model to_model() const;

  [[nodiscard]] uint64_t step() const { return step_; }
  [[nodiscard]] const Config& config() const { return config_; }
  [[nodiscard]] const NamedTensors& parameters() const { return network_.parameters(); }
  [[nodiscard]] const NamedTensors& average() const { return average_; }

 private:
  Trainer(Config config, Batches batches, NetworkModule network, torch::Device device, const Peers& peers);
  [[nodiscard]] std::vector<torch::Tensor> state() const;
  [[nodiscard]] Result<void> start_together();
  [[nodiscard]] Result<bool> any_peer(bool value) const;
  [[nodiscard]] Result<void> backward(const torch::Tensor& loss);
  [[nodiscard]] Result<StepReport> average_over_peers(const StepReport& report) const;
  [[nodiscard]] Result<void> replace_by_peers_mean(const NamedTensors& tensors) const;
  [[nodiscard]] bool learning_patterns() const {
    return !fixed_codes_.defined() && step_ < config_.patterns.learn_steps;
  }
  [[nodiscard]] torch::Tensor current_codes() const;
  [[nodiscard]] torch::ScalarType compute_type() const;
  [[nodiscard]] StepRow step_row(const StepReport& report, double samples_per_s) const;
  [[nodiscard]] Result<void> log_evaluation(const RunLog& log) const;

  Config config_;
  torch::Device device_;
  Peers peers_;
  Batches batches_;
  NetworkModule network_;
  Patterns patterns_;
  torch::Tensor fixed_codes_;  // undefined while patterns come from patterns_
  NamedTensors pattern_parameters_;
  NamedTensors by_muon_, by_adam_;  ///< the network's parameters, by who moves them
  Muon muon_;
  Adam adam_, pattern_adam_;
  NamedTensors average_;
  GradientExchange exchange_;
  uint64_t step_ = 0;
};

/// The learning rate of a step: a linear warm-up, the peak until `hold_steps`, then half a cosine to zero.
[[nodiscard]] double learning_rate(const TrainConfig& train, uint64_t step);

}  // namespace e2lf::learn
