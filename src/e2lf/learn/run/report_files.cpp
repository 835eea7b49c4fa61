// SPDX-License-Identifier: MIT
#include "e2lf/learn/run/report_files.h"

#include <algorithm>
#include <string>

#include "e2lf/files/file.h"
#include "e2lf/learn/run/run_log.h"

namespace e2lf::learn {
namespace fs = std::filesystem;

Result<void> check_reports(const ReportFiles& files, const fs::path& run) {
  for (const fs::path& name : files.names) {
    const auto format = report::file_format_of(name);
    if (!format) return format.error();
    E2LF_RETURN_IF_ERROR(check_output(name, files.overwrite));
    std::error_code error;
    const auto folder_of = [&](const fs::path& path) { return fs::weakly_canonical(fs::absolute(path), error); };
    const std::vector<std::string> of_run = RunLog::file_names();
    if (!run.empty() && folder_of(name).parent_path() == folder_of(run) &&
        std::find(of_run.begin(), of_run.end(), name.filename().string()) != of_run.end()) {
      return Error{ErrorCode::kInvalidValue, "the run writes a file with this name; choose another file for the report",
                   name.string()};
    }
  }
  return {};
}

Result<void> write_reports(const ReportFiles& files, const report::Page& page) {
  for (const fs::path& name : files.names) {
    E2LF_ASSIGN_OR_RETURN(const report::FileFormat format, report::file_format_of(name));
    E2LF_RETURN_IF_ERROR(write_file(name, report::file_text(page, format)));
  }
  return {};
}

}  // namespace e2lf::learn
