// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "e2lf/files/options.h"
#include "e2lf/program/report_output.h"
#include "e2lf/program/verb.h"
#include "e2lf/report/table.h"

/// The output of benchmarks: printed text, JSON and the files of --report.
namespace e2lf::bench {

using program::ReportOutput;
using program::Verb;

/// The results of a benchmark as text and tables.
struct BenchReport {
  std::string title, about;                ///< about: sizes, threads, and the meaning of the figures
  std::vector<report::Table> tables = {};  ///< captions are only shown on the page
  std::string note = {};                   ///< below the tables
};

/// Prints the results, as JSON if the verb has --json, and writes the files of --report.
[[nodiscard]] Result<void> finish(const Verb& verb, const Json& json, const BenchReport& found, ReportOutput& reports);

/// Opens the files of --report before the work.
[[nodiscard]] Result<ReportOutput> open_reports(const std::vector<std::filesystem::path>& names, const Verb& verb);

}  // namespace e2lf::bench
