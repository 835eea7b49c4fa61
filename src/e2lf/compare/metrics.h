// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>
#include <vector>

namespace e2lf::compare {

/// A figure of a result.
struct Metric {
  const char* name;     ///< in configurations and results
  const char* heading;  ///< in tables
  int decimals;
  bool is_least_best;
  bool is_quality;     ///< of the light field; else what it costs
  bool is_repeatable;  ///< the same in every run
};

/// All of them.
[[nodiscard]] std::span<const Metric> all_metrics();

/// Those of these names, in the order of all_metrics(); names that are none are left out.
[[nodiscard]] std::vector<Metric> metrics_of(const std::vector<std::string>& names);

}  // namespace e2lf::compare
