// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/program/run_record.h"
#include "e2lf/report/page.h"

namespace e2lf::program {

/// Declares --report: files that report on the run, a page (.html) or its tables (.csv, .tex).
void add_report_option(CLI::App& app, std::vector<std::filesystem::path>& names);

/// The files of --report.
class ReportOutput {
 public:
  /// Checks all files before any work. Fails as OutputFile::create() does.
  [[nodiscard]] static Result<ReportOutput> open(const std::vector<std::filesystem::path>& names,
                                                 const OutputRules& rules);
  [[nodiscard]] bool is_wanted() const { return !files_.empty(); }
  /// Writes the report to all files. Fails with kIo, and as OutputFile::commit() does.
  [[nodiscard]] Result<void> write(const report::Page& page);

 private:
  struct File {
    report::FileFormat format;
    OutputFile output;
  };
  std::vector<File> files_;
};

/// Creates the page of a verb with its title and the command line.
[[nodiscard]] report::Page verb_page(const std::string& title);

/// Declares --plot: a chart, as .svg or .png.
void add_chart_option(CLI::App& app, std::filesystem::path& name, const std::string& help);

/// The file of --plot.
class ChartOutput {
 public:
  /// Checks the file, if there is a name, before any work. Fails as OutputFile::create() does.
  [[nodiscard]] static Result<ChartOutput> open(const std::filesystem::path& name, OutputRules rules);
  [[nodiscard]] bool is_wanted() const { return file_.has_value(); }
  /// Writes the chart. Fails with kIo, and as film::draw_svg() and OutputFile::commit() do.
  [[nodiscard]] Result<void> write(const std::string& svg);

 private:
  std::filesystem::path name_;
  std::optional<OutputFile> file_;
};

}  // namespace e2lf::program
