// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "e2lf/base/progress.h"
#include "e2lf/learn/optimisers/optimisers.h"
#include "e2lf/learn/run/config.h"
#include "e2lf/learn/run/peers.h"
#include "e2lf/learn/run/run_log.h"
#include "e2lf/learn/run/task.h"

namespace e2lf::learn {

/// The result of one training step.
struct StepReport {
  double loss = 0;           ///< the function whose gradient is computed
  double figure = 0;         ///< plain mean squared error, or the share of disparities that are wrong
  double gradient_norm = 0;  ///< before clipping
};

/// Trains the network of a task, and the patterns jointly with it. Checkpoints contain everything that
/// changes between steps, and the random numbers of a step depend only on the seed and the step's number, so that a
/// resumed run continues bit-exactly on the same machine.
class Trainer {
 public:
  /// Reads the data and prepares step 0. Fails as open_task() and (for `start` and `codes`) read_model() do, and with
  /// kInvalidValue if the batch cannot be divided evenly among the peers.
  [[nodiscard]] static Result<Trainer> create(const Config& config, const Peers& peers = {});

  /// Trains until config.train.steps, starting at the step of the first peer, which writes config.json, log.csv,
  /// evaluation.csv and checkpoint.safetensors in the folder. `keep_going` is called after each step; if it returns
  /// false in any process, all write a checkpoint and fail with kCancelled. Fails with kInvalidValue if the loss is no
  /// longer finite, and with kIo if a peer is lost; the last valid checkpoint is kept.
  [[nodiscard]] Result<void> run(const std::filesystem::path& folder, const ProgressFn& progress = {},
                                 const std::function<bool()>& keep_going = {});

  /// Performs one step without logs or files. Fails with kIo if a peer is lost.
  [[nodiscard]] Result<StepReport> train_step();

  [[nodiscard]] Result<void> save_checkpoint(const std::filesystem::path& path) const;
  [[nodiscard]] Result<void> load_checkpoint(const std::filesystem::path& path);

  /// Evaluates the averaged weights on the named scenes, as recorded by a camera over `cycles` cycles:
  /// Task::evaluate().
  [[nodiscard]] Result<std::vector<SceneScore>> evaluate(const std::vector<std::string>& scenes,
                                                         const capture::SensorProfile& camera, size_t cycles = 1) const;

  /// Returns the cameras with which evaluations are made: the paper's at its nominal constants, and sensor.camera.
  [[nodiscard]] std::vector<capture::SensorProfile> cameras() const;

  /// Returns the averaged weights and the patterns as a model. Patterns that are still being learned are rounded to 0
  /// and 1. Fails as Task::complete() does.
  [[nodiscard]] Result<model::Model> to_model() const;

  [[nodiscard]] uint64_t step() const { return step_; }
  [[nodiscard]] const Config& config() const { return config_; }
  [[nodiscard]] const NamedTensors& parameters() const { return task_->network().parameters(); }
  [[nodiscard]] const NamedTensors& average() const { return average_; }
  [[nodiscard]] LogFigures figures() const { return task_->figures(); }

 private:
  Trainer(Config config, std::unique_ptr<Task> task, torch::Device device, const Peers& peers);
  [[nodiscard]] Result<void> choose_patterns();
  [[nodiscard]] Result<void> start_at(const std::string& name);
  /// Returns all tensors that change between steps, with the prefixes of their names in checkpoints.
  [[nodiscard]] std::vector<std::pair<const char*, const NamedTensors*>> state() const;
  [[nodiscard]] Result<void> start_together();
  [[nodiscard]] Result<bool> any_peer(bool value) const;
  [[nodiscard]] Result<void> backward(const torch::Tensor& loss);
  [[nodiscard]] Result<void> replace_by_peers_mean(const NamedTensors& tensors) const;
  [[nodiscard]] bool learning_patterns() const {
    return !fixed_codes_.defined() && step_ < config_.patterns.learn_steps;
  }
  [[nodiscard]] torch::Tensor current_codes() const;
  [[nodiscard]] StepRow step_row(const StepReport& report, double samples_per_s) const;
  [[nodiscard]] Result<void> log_evaluation(const RunLog& log) const;

  Config config_;
  torch::Device device_;
  Peers peers_;
  std::unique_ptr<Task> task_;
  Patterns patterns_;
  torch::Tensor fixed_codes_;  // undefined while patterns_ is trained
  NamedTensors pattern_parameters_;
  NamedTensors by_muon_, by_adam_;  ///< the parameters of the network, by the optimiser that updates them
  Muon muon_;
  Adam adam_, pattern_adam_;
  NamedTensors average_;
  uint64_t step_ = 0;
};

/// Returns the learning rate of a step: a linear warm-up, the peak until `hold_steps`, then half a cosine down to zero.
[[nodiscard]] double learning_rate(const TrainConfig& train, uint64_t step);

}  // namespace e2lf::learn
