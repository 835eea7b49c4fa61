// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/report/page.h"

namespace e2lf::learn {

/// The files to which a report is written: pages (.html) and their tables (.csv, .tex).
struct ReportFiles {
  std::vector<std::filesystem::path> names = {};
  bool overwrite = false;
};

/// Checks the files before any work. Fails with kUnsupported (another extension), kExists, and kInvalidValue (a report
/// would replace a file that the run writes in its folder). An empty `run` means that there is no such folder.
[[nodiscard]] Result<void> check_reports(const ReportFiles& files, const std::filesystem::path& run = {});

/// Writes the report to all files; each appears complete or not at all. Fails with kIo.
[[nodiscard]] Result<void> write_reports(const ReportFiles& files, const report::Page& page);

}  // namespace e2lf::learn
