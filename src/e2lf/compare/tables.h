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

/// Makes a table with methods in rows, and groups and (if there are several) their mean in columns. A cell holds the
/// metrics of quality, "28.40/0.8330": the mean over the seeds of each scene, then over the scenes of the group. It is
/// empty if a result or its figure is missing, because a mean over fewer of them is not comparable.
[[nodiscard]] report::Table quality_table(const Plan& plan, const Results& results, size_t sensor);

/// Makes a table with methods in rows and the costs of a light field in columns, as means of groups. It has only the
/// column of names if no such metric is requested.
[[nodiscard]] report::Table cost_table(const Plan& plan, const Results& results, size_t sensor);

/// Returns all tables as JSON: {"name", "sensors": [{"sensor", "quality", "cost"}], "results": [...]}.
[[nodiscard]] Json all_json(const Plan& plan, const Results& results);

/// The names of the files of write_tables().
inline constexpr const char* kTableFiles[] = {"index.html", "table.csv", "table.json", "table.tex"};

/// Writes the page, with tables and pictures in a single file, and the tables of a comparison to an existing folder.
/// table.csv has one row per result and the metrics that are identical in every run. The page shows `command` as the
/// command that made it. Fails with kIo.
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
