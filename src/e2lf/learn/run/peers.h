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

/// The processes that train one model together, each on its share of every batch, joined through torch's c10d. All
/// calls are collective: every process makes the same ones in the same order. A peer that ends or falls silent for
/// kPatience fails the calls of all others with kIo.
class Peers {
 public:
  static constexpr std::chrono::seconds kPatience{45};

  /// One process by itself.
  Peers() = default;

  /// What torchrun's environment variables say: alone when WORLD_SIZE is absent or 1, otherwise process RANK of
  /// WORLD_SIZE that meet at MASTER_ADDR:MASTER_PORT. Fails with kInvalidValue for a missing or wrong variable,
  /// kUnsupported when torch was built without c10d, and kIo when not all come in kPatience.
  [[nodiscard]] static Result<Peers> meet();

  /// The text that process 0 passes, e.g. a configuration. Works before connect().
  [[nodiscard]] Result<std::string> text_from_first(const std::string& text) const;

  /// Opens the way for tensors on a device: NCCL for CUDA, Gloo otherwise, on the interface GLOO_SOCKET_IFNAME or the
  /// one that leads to MASTER_ADDR. Fails with kUnsupported when this build has neither, and kIo.
  [[nodiscard]] Result<void> connect(torch::Device device);

  [[nodiscard]] int rank() const { return rank_; }
  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] bool leads() const { return rank_ == 0; }

  /// Replaces a tensor by its sum over all processes.
  [[nodiscard]] Result<void> sum(const torch::Tensor& tensor) const;

  /// The same while the caller goes on: `finish` waits for it. Throws where sum() fails.
  using Finish = std::function<void()>;
  [[nodiscard]] Finish begin_sum(const torch::Tensor& tensor) const;

  /// Replaces a tensor by that of process 0.
  [[nodiscard]] Result<void> copy_from_first(const torch::Tensor& tensor) const;

  /// The error that the failure of a collective call means.
  [[nodiscard]] static Error lost(const std::exception& error);

 private:
  struct Group;  // c10d types stay out of headers: they differ between torch's versions and builds
  int rank_ = 0, size_ = 1;
  std::shared_ptr<Group> group_;
};

}  // namespace e2lf::learn
