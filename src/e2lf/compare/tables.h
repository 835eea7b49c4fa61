// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "e2lf/compare/jobs.h"
#include "e2lf/compare/plan.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/lightfield/light_field.h"
#include "e2lf/report/table.h"

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

/// The figures of each job of a plan, as far as they exist.
using Results = std::vector<std::optional<Json>>;

/// Returns the mean of a metric over the seeds of one method, scene and sensor. Returns nothing if a result or its
/// figure is missing, because a mean over fewer seeds is not comparable.
[[nodiscard]] std::optional<double> scene_mean(const Plan& plan, const Results& results, const Job& of,
                                               const char* metric);

/// Return the mean over the scenes of a group, and the mean over the groups as in the paper. Return nothing if a value
/// is missing.
[[nodiscard]] std::optional<double> group_mean(const Plan& plan, const Results& results, size_t method, size_t sensor,
                                               const std::string& group, const char* metric);
[[nodiscard]] std::optional<double> mean_of_groups(const Plan& plan, const Results& results, size_t method,
                                                   size_t sensor, const char* metric);

/// Makes a table with methods in rows, and groups and (if there are several) their mean in columns. A cell holds the
/// metrics of quality, "28.40/0.8330".
[[nodiscard]] report::Table quality_table(const Plan& plan, const Results& results, size_t sensor);

/// Makes a table with methods in rows and the costs of a light field in columns, as means of groups. It has only the
/// column of names if no such metric is requested.
[[nodiscard]] report::Table cost_table(const Plan& plan, const Results& results, size_t sensor);

/// Makes a table with one row per result and the metrics that are identical in every run.
[[nodiscard]] report::Table result_table(const Plan& plan, const Results& results);

/// Returns all tables as JSON: {"name", "sensors": [{"sensor", "quality", "cost"}], "results": [...]}.
[[nodiscard]] Json all_json(const Plan& plan, const Results& results);

/// Makes the page of a comparison as a single file: tables and pictures. `command` is shown as the command that made
/// it.
[[nodiscard]] std::string result_page(const Plan& plan, const Results& results, const ResultStore& store,
                                      const std::string& command);

/// The names of the files of write_tables().
inline constexpr const char* kTableFiles[] = {"index.html", "table.csv", "table.json", "table.tex"};

/// Writes the page and the tables of a comparison to an existing folder. Fails with kIo.
[[nodiscard]] Result<void> write_tables(const std::filesystem::path& folder, const Plan& plan, const Results& results,
                                        const ResultStore& store, const std::string& command);

/// Draws a preview of a light field: its upper left view with an enlarged inset of the middle and, below it, the
/// horizontal EPI of the middle row. If a truth of the same shape is given, the error of this view is drawn beside it,
/// from black for none to white for 0.2 and more. Views wider than 320 px are shrunk. Unless `disparity` is empty, it
/// is drawn below in the colours of depth::colour_picture(), over the range of `true_disparity`, or its own if that is
/// empty.
[[nodiscard]] lightfield::Image look(const lightfield::LightField& field, const lightfield::LightField* truth,
                                     const lightfield::Image& disparity = {},
                                     const lightfield::Image& true_disparity = {});

}  // namespace e2lf::compare
