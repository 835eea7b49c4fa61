// SPDX-License-Identifier: MIT
#include "e2lf/program/report_output.h"

#include <fstream>
#include <vector>

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/film/draw_svg.h"
#include "e2lf/film/film_file.h"
#include "e2lf/program/verb.h"
#include "e2lf/report/chart.h"

namespace e2lf::program {
namespace fs = std::filesystem;
namespace {

/// Returns the command line as it was typed, as far as possible.
std::string command_line() {
  std::ifstream in("/proc/self/cmdline", std::ios::binary);
  std::vector<std::string> words;
  for (std::string word; std::getline(in, word, '\0');) words.push_back(shell_word(word));
  if (!words.empty()) words.front() = "e2lf";
  return join(words, " ");
}

}  // namespace

void add_report_option(CLI::App& app, std::vector<fs::path>& names) {
  const auto check = [](std::string& text) {
    const auto format = report::file_format_of(text);
    return format ? std::string() : format.error().text();
  };
  app.add_option("--report", names,
                 "also write a report of the run: a page (.html) or its tables (.tex; .csv for the first one); may be "
                 "given several times")
      ->check(CLI::Validator(check, ""))
      ->allow_extra_args(false);
}

Result<ReportOutput> ReportOutput::open(const std::vector<fs::path>& names, const OutputRules& rules) {
  ReportOutput made;
  for (const fs::path& name : names) {
    E2LF_ASSIGN_OR_RETURN(const report::FileFormat format, report::file_format_of(name));
    E2LF_ASSIGN_OR_RETURN(OutputFile output, OutputFile::create(name, rules));
    made.files_.push_back({format, std::move(output)});
  }
  return made;
}

Result<void> ReportOutput::write(const report::Page& page) {
  for (File& file : files_) {
    E2LF_RETURN_IF_ERROR(write_file(file.output.path(), report::file_text(page, file.format)));
    E2LF_RETURN_IF_ERROR(file.output.commit());
  }
  return {};
}

report::Page verb_page(const std::string& title) {
  report::Page page(title);
  page.code(command_line());
  return page;
}

void add_chart_option(CLI::App& app, fs::path& name, const std::string& help) {
  const auto check = [](std::string& text) {
    const std::string extension = fs::path(text).extension().string();
    return extension == ".svg" || extension == ".png"
               ? std::string()
               : cat("the chart is an SVG or PNG image; give it a name that ends in .svg or .png, not ", text);
  };
  app.add_option("--plot", name, help)->check(CLI::Validator(check, ""));
}

Result<ChartOutput> ChartOutput::open(const fs::path& name, OutputRules rules) {
  ChartOutput chart;
  chart.name_ = name;
  if (name.extension() == ".png") E2LF_RETURN_IF_ERROR(located(film::check_film_support(), name));
  rules.streams = true;
  E2LF_ASSIGN_OR_RETURN(chart.file_, OutputFile::create_optional(name, rules));
  return chart;
}

Result<void> ChartOutput::write(const std::string& svg) {
  constexpr size_t kWidth = 1800;  // twice the width of the drawing
  const std::string drawing = report::file_svg(svg);
  if (name_.extension() == ".png") {
    E2LF_ASSIGN_OR_RETURN(const lightfield::Image image, located(film::draw_svg(drawing, kWidth), name_));
    E2LF_RETURN_IF_ERROR(lightfield::write_png(file_->path(), lightfield::to_bytes(image)));
  } else {
    E2LF_RETURN_IF_ERROR(write_file(file_->path(), drawing));
  }
  return file_->commit();
}

}  // namespace e2lf::program
