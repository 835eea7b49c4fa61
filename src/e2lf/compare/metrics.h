// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>
#include <vector>

namespace e2lf::compare {

/// A figure of merit of a result.
struct Metric {
  const char* name;     ///< in configurations and results
  const char* heading;  ///< in tables
  int decimals;
  bool is_least_best;
  bool is_quality;     ///< true for the quality of the light field, false for its cost
  bool is_repeatable;  ///< identical in every run
};

/// Returns all metrics.
[[nodiscard]] std::span<const Metric> all_metrics();

/// Returns the metrics of these names in the order of all_metrics(). Unknown names are ignored.
[[nodiscard]] std::vector<Metric> metrics_of(const std::vector<std::string>& names);

}  // namespace e2lf::compare
