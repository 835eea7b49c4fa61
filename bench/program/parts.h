// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "e2lf/files/options.h"
#include "e2lf/model/model.h"

/// Functions that the benchmarks of networks share.
namespace e2lf::bench {

struct Timing {
  double median = 0.0, min = 0.0, max = 0.0;
};

/// Returns the statistics of at least one measured time.
[[nodiscard]] Timing timing_of(std::vector<double> seconds);
[[nodiscard]] Json to_json(const Timing& timing);

/// Returns random weights that preserve the magnitude of values from layer to layer.
[[nodiscard]] model::Weights random_weights(const model::Network& network);

/// Returns a function of the module e2lf_torch_peer.so, which is beside the program or at `module`. If there is none,
/// returns null, and `absent` states the reason.
[[nodiscard]] void* find_torch_peer(const std::filesystem::path& module, const char* function, std::string& absent);

}  // namespace e2lf::bench
