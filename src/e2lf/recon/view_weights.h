// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "e2lf/capture/patterns/codes.h"

namespace e2lf::recon {

/// The prior for the views of a light field at one (disparity-corrected) point.
struct ViewPrior {
  double correlation_length = 8.0;  ///< in view steps: correlation exp(-distance^2 / (2 length^2))
  double noise = 0.3;  ///< variance of the noise of a normalised coded image relative to the variance of a view; must
                       ///< be positive if two patterns are alike
};

/// Computes the best linear unbiased estimate of each view from the coded images J_n = I_n / (share of open cells), as
/// weights [view][pattern] that sum to 1 over the patterns and are 0 for patterns without light. With K the prior
/// correlation of the views and B the patterns scaled to sum 1, w is the solution of
///   (B K B^T + noise) w + m = B K e_v,  sum(w) = 1
/// (kriging with unknown mean m). At least one pattern must transmit light, or the contract is broken.
[[nodiscard]] std::vector<std::vector<double>> view_weights(const capture::Codes& codes, const ViewPrior& prior);

}  // namespace e2lf::recon
