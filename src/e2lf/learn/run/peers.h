// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <torch/types.h>
#include <vector>

#include "e2lf/base/result.h"

namespace e2lf::learn {

/// The processes that train one model together, each on its share of every batch, connected through torch's c10d. All
/// calls are collective: every process must make the same calls in the same order. If a peer ends or does not respond
/// for kPatience, the calls of all others fail with kIo.
class Peers {
 public:
  static constexpr std::chrono::seconds kPatience{45};

  /// A single process.
  Peers() = default;

  /// Joins the processes that torchrun's environment variables describe: process RANK of WORLD_SIZE, which all meet at
  /// MASTER_ADDR:MASTER_PORT. Without WORLD_SIZE, it joins the tasks of a Slurm step (SLURM_PROCID of
  /// SLURM_STEP_NUM_TASKS), which meet on the step's first host. A process with neither is alone. Fails with
  /// kInvalidValue (a missing or invalid variable), kUnsupported (torch was built without c10d) and kIo (not all
  /// processes joined within kPatience).
  [[nodiscard]] static Result<Peers> meet();

  /// Returns the text that process 0 passes, e.g. a configuration. May be called before connect().
  [[nodiscard]] Result<std::string> text_from_first(const std::string& text) const;

  /// Opens the connection for tensors on a device: NCCL for CUDA, otherwise Gloo, on the interface GLOO_SOCKET_IFNAME
  /// or the one that leads to MASTER_ADDR. Fails with kUnsupported (this build has neither) and kIo.
  [[nodiscard]] Result<void> connect(torch::Device device);

  [[nodiscard]] int rank() const { return rank_; }
  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] bool leads() const { return rank_ == 0; }

  /// Replaces a tensor by its sum over all processes.
  [[nodiscard]] Result<void> sum(const torch::Tensor& tensor) const;

  using Finish = std::function<void()>;
  /// Starts the same sum and returns at once. The returned function waits for it and throws where sum() would fail.
  [[nodiscard]] Finish begin_sum(const torch::Tensor& tensor) const;

  /// Replaces a tensor by that of process 0.
  [[nodiscard]] Result<void> copy_from_first(const torch::Tensor& tensor) const;

  /// Returns the error that describes the failure of a collective call.
  [[nodiscard]] static Error lost(const std::exception& error);

 private:
  struct Group;  // keeps the types of c10d out of headers: they differ between versions and builds of torch
  int rank_ = 0, size_ = 1;
  std::shared_ptr<Group> group_;
};

/// Averages gradients over all processes while the backward pass is running. Parameters are packed into buckets in the
/// order in which their gradients become available, and a bucket is sent as soon as it is full.
class GradientExchange {
 public:
  /// `parameters` are leaves in the expected order of their gradients, which must be the same in every process.
  GradientExchange(const Peers& peers, std::vector<torch::Tensor> parameters);

  /// Must be called before each backward pass.
  void begin();

  /// Must be called after each backward pass; every defined gradient is then the mean over the processes. Fails with
  /// kIo if a peer is lost.
  [[nodiscard]] Result<void> finish();

 private:
  struct State;  // the hooks of the parameters refer to it even if the exchange is moved
  std::shared_ptr<State> state_;
};

}  // namespace e2lf::learn
