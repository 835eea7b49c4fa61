// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/cli/output/report_output.h"
#include "e2lf/cli/verb.h"
#include "e2lf/files/options.h"
#include "e2lf/report/chart.h"
#include "e2lf/report/table.h"

/// What benchmarks print, and write with --report.
namespace e2lf::bench {

using cli::ReportOutput;
using cli::Verb;

/// What a benchmark found, to be read.
struct BenchReport {
  std::string title, about;                ///< about: sizes, threads, and what the figures mean
  std::vector<report::Table> tables = {};  ///< their captions are for the page alone
  std::vector<report::BarChart> charts = {};
  std::string note = {};  ///< below the tables
};

/// A chart of one column over the names in the first column.
[[nodiscard]] report::BarChart bars_of(const report::Table& table, size_t column, const std::string& label);

/// Prints what was found, as JSON where that is asked for, and writes the files of --report.
[[nodiscard]] Result<void> finish(const Verb& verb, const Json& json, const BenchReport& found, ReportOutput& reports);

/// Opens the files of --report before the work.
[[nodiscard]] Result<ReportOutput> open_reports(const std::vector<std::filesystem::path>& names, const Verb& verb);

}  // namespace e2lf::bench
