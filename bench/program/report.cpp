// SPDX-License-Identifier: MIT
#include "bench/program/report.h"

#include <cstdio>

#include "e2lf/files/options.h"
#include "e2lf/program/run_record.h"

namespace e2lf::bench {
using namespace program;

Result<ReportOutput> open_reports(const std::vector<std::filesystem::path>& names, const Verb& verb) {
  return ReportOutput::open(names, output_rules(verb, {}));
}

Result<void> finish(const Verb& verb, const Json& json, const BenchReport& found, ReportOutput& reports) {
  if (reports.is_wanted()) {
    report::Page page = verb_page(found.title);
    page.paragraph(found.about);
    for (const report::Table& table : found.tables) page.table(table);
    if (!found.note.empty()) page.paragraph(found.note);
    page.heading("All figures").facts(json);
    E2LF_RETURN_IF_ERROR(reports.write(page));
  }
  if (verb.common().json) {
    std::printf("%s", json_text(json).c_str());
    return {};
  }
  if (verb.common().quiet && reports.is_wanted()) return {};
  std::printf("%s\n", found.about.c_str());
  for (const report::Table& table : found.tables) std::printf("\n%s", report::table_text(table).c_str());
  if (!found.note.empty()) std::printf("\n%s\n", found.note.c_str());
  return {};
}

}  // namespace e2lf::bench
