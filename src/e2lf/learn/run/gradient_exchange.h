// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <torch/types.h>
#include <vector>

#include "e2lf/learn/run/peers.h"

namespace e2lf::learn {

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
