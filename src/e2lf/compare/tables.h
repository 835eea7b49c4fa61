// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "e2lf/compare/metrics.h"
#include "e2lf/compare/plan.h"
#include "e2lf/report/table.h"

namespace e2lf::compare {

/// The figures of each job of a plan, as far as they are there.
using Results = std::vector<std::optional<Json>>;

/// The mean of a metric over the seeds of one method, scene and sensor. Nothing where a result or its figure is
/// missing: a mean over other seeds is another figure.
[[nodiscard]] std::optional<double> scene_mean(const Plan& plan, const Results& results, const Job& of,
                                               const char* metric);

/// The mean over the scenes of a group, and over the groups as the paper has it; nothing where one is missing.
[[nodiscard]] std::optional<double> group_mean(const Plan& plan, const Results& results, size_t method, size_t sensor,
                                               const std::string& group, const char* metric);
[[nodiscard]] std::optional<double> mean_of_groups(const Plan& plan, const Results& results, size_t method,
                                                   size_t sensor, const char* metric);

/// Methods in rows, groups and, of several, their mean in columns; a cell holds the metrics of quality, "28.40/0.8330".
[[nodiscard]] report::Table quality_table(const Plan& plan, const Results& results, size_t sensor);

/// Methods in rows, what a light field costs in columns: means of groups. No columns but the names where no such metric
/// is asked for.
[[nodiscard]] report::Table cost_table(const Plan& plan, const Results& results, size_t sensor);

/// A row for each result with the metrics that are the same in every run.
[[nodiscard]] report::Table result_table(const Plan& plan, const Results& results);

/// Everything for programs: {"name", "sensors": [{"sensor", "quality", "cost"}], "results": [...]}.
[[nodiscard]] Json all_json(const Plan& plan, const Results& results);

}  // namespace e2lf::compare
