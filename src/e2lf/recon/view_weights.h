// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "e2lf/capture/patterns/codes.h"

namespace e2lf::recon {

/// What is assumed of the views of a light field at one (disparity-corrected) point.
struct ViewPrior {
  double correlation_length = 8.0;  ///< in view steps: correlation exp(-distance^2 / (2 length^2))
  double noise = 0.3;               ///< variance of a normalised coded image over that of a view;
                                    ///< positive where two patterns are alike
};

/// The best linear unbiased estimate of each view from the coded images J_n = I_n / (share of open cells): weights
/// [view][pattern] that sum to 1 over the patterns, 0 for patterns without light. With K the prior correlation of the
/// views and B the patterns scaled to sum 1: the solution w of
///   (B K B^T + noise) w + m = B K e_v,  sum(w) = 1
/// (kriging with unknown mean m). At least one pattern must let light through; else the contract is broken.
[[nodiscard]] std::vector<std::vector<double>> view_weights(const capture::Codes& codes, const ViewPrior& prior);

}  // namespace e2lf::recon
