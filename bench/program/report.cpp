// SPDX-License-Identifier: MIT
#include "bench/program/report.h"

#include <cstdio>

#include "e2lf/files/options.h"
#include "e2lf/program/run_record.h"

namespace e2lf::bench {
using namespace program;

report::BarChart bars_of(const report::Table& table, size_t column, const std::string& label) {
  report::BarChart chart{label, true, 3, {}, {{table.columns.at(column).name, {}}}};
  for (const auto& row : table.rows) {
    if (!row[column].value.is_number()) continue;
    chart.groups.push_back(row[0].text);
    chart.series[0].values.emplace_back(row[column].value.get<double>());
  }
  return chart;
}

Result<ReportOutput> open_reports(const std::vector<std::filesystem::path>& names, const Verb& verb) {
  return ReportOutput::open(names, output_rules(verb, {}));
}

Result<void> finish(const Verb& verb, const Json& json, const BenchReport& found, ReportOutput& reports) {
  if (reports.is_wanted()) {
    report::Page page = verb_page(found.title);
    page.paragraph(found.about);
    for (const report::Table& table : found.tables) page.table(table);
    if (!found.note.empty()) page.paragraph(found.note);
    for (const report::BarChart& chart : found.charts) page.drawing(report::chart_svg(chart));
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
