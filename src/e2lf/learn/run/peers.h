// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <torch/types.h>

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

  /// Replaces a tensor by that of process 0.
  [[nodiscard]] Result<void> copy_from_first(const torch::Tensor& tensor) const;

 private:
  struct Group;  // keeps the types of c10d out of headers: they differ between versions and builds of torch
  int rank_ = 0, size_ = 1;
  std::shared_ptr<Group> group_;
};

}  // namespace e2lf::learn
