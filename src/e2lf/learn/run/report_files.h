// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/report/page.h"

namespace e2lf::learn {

/// Where the report of a verb goes: pages (.html) and their tables (.csv, .tex).
struct ReportFiles {
  std::vector<std::filesystem::path> names = {};
  bool overwrite = false;
};

/// Before any work. Fails with kUnsupported (another extension), kExists, and kInvalidValue where a report would take
/// the place of a file that the run writes in its folder; an empty `run` is none.
[[nodiscard]] Result<void> check_reports(const ReportFiles& files, const std::filesystem::path& run = {});

/// Each file appears whole. Fails with kIo.
[[nodiscard]] Result<void> write_reports(const ReportFiles& files, const report::Page& page);

}  // namespace e2lf::learn
