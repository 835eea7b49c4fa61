// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "e2lf/compare/jobs.h"
#include "e2lf/compare/tables.h"

namespace e2lf::compare {

/// Makes the page of a comparison as a single file: tables, bars for each scene, the PSNR of the views, patterns with
/// their events, and pictures. `command` is shown as the command that made it.
[[nodiscard]] std::string result_page(const Plan& plan, const Results& results, const ResultStore& store,
                                      const std::string& command);

/// The names of the files of write_tables().
inline constexpr const char* kTableFiles[] = {"index.html", "table.csv", "table.json", "table.tex"};

/// Writes the page and the tables of a comparison to an existing folder. Fails with kIo.
[[nodiscard]] Result<void> write_tables(const std::filesystem::path& folder, const Plan& plan, const Results& results,
                                        const ResultStore& store, const std::string& command);

}  // namespace e2lf::compare
