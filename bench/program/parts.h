// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "e2lf/files/options.h"
#include "e2lf/model/model.h"

/// What the benchmarks of networks share.
namespace e2lf::bench {

struct Timing {
  double median = 0.0, min = 0.0, max = 0.0;
};

/// Of some seconds, at least one.
[[nodiscard]] Timing timing_of(std::vector<double> seconds);
[[nodiscard]] Json to_json(const Timing& timing);

/// Random weights with which outputs are about as large as inputs.
[[nodiscard]] model::Weights random_weights(const model::Network& network);

/// A function of the module e2lf_torch_peer.so, which lies beside the program or at `module`; where there is none, why
/// goes to `absent`.
[[nodiscard]] void* find_torch_peer(const std::filesystem::path& module, const char* function, std::string& absent);

}  // namespace e2lf::bench
