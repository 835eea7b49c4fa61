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

/// Declares --report: files that report on the run, a page (.html), its tables (.csv, .tex) or its first
/// chart (.svg).
void add_report_option(CLI::App& app, std::vector<std::filesystem::path>& names);

/// The files of --report.
class ReportOutput {
 public:
  /// Checks all files before any work. Fails as OutputFile::create() does.
  [[nodiscard]] static Result<ReportOutput> open(const std::vector<std::filesystem::path>& names,
                                                 const OutputRules& rules);
  [[nodiscard]] bool is_wanted() const { return !files_.empty(); }
  /// Writes the report to all files. Fails with kIo, and as report::file_text() and OutputFile::commit() do.
  [[nodiscard]] Result<void> write(const report::Page& page);

 private:
  struct File {
    std::filesystem::path name;
    OutputFile output;
  };
  std::vector<File> files_;
};

/// Creates the page of a verb with its title and the command line.
[[nodiscard]] report::Page verb_page(const std::string& title);

}  // namespace e2lf::program
