// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <torch/types.h>
#include <vector>

#include "e2lf/learn/run/peers.h"

namespace e2lf::learn {

/// Averages gradients over all processes while the backward pass is still running: parameters are packed into buckets
/// in the order in which their gradients come, and a bucket leaves as soon as it is full.
class GradientExchange {
 public:
  /// `parameters`: leaves in the expected order of their gradients, the same in every process.
  GradientExchange(const Peers& peers, std::vector<torch::Tensor> parameters);

  /// Before each backward pass.
  void begin();

  /// After it: every defined gradient is the mean over the processes. Fails with kIo when a peer is lost.
  [[nodiscard]] Result<void> finish();

 private:
  struct State;  // the parameters' hooks refer to it, wherever the exchange is moved
  std::shared_ptr<State> state_;
};

}  // namespace e2lf::learn
