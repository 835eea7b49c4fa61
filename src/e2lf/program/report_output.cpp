// SPDX-License-Identifier: MIT
#include "e2lf/program/report_output.h"

#include "e2lf/base/text.h"
#include "e2lf/files/file.h"
#include "e2lf/program/sibling_program.h"
#include "e2lf/program/verb.h"

namespace e2lf::program {
namespace fs = std::filesystem;
void add_report_option(CLI::App& app, std::vector<fs::path>& names) {
  const auto check = [](std::string& text) {
    const auto known = report::check_extension(text);
    return known ? std::string() : known.error().text();
  };
  app.add_option(
         "--report", names,
         "also write a report of the run: a page (.html), its tables (.tex; .csv for the first one) or its first "
         "chart (.svg); may be given several times")
      ->check(CLI::Validator(check, ""))
      ->allow_extra_args(false);
}

Result<ReportOutput> ReportOutput::open(const std::vector<fs::path>& names, const OutputRules& rules) {
  ReportOutput made;
  for (const fs::path& name : names) {
    E2LF_ASSIGN_OR_RETURN(OutputFile output, OutputFile::create(name, rules));
    made.files_.push_back({name, std::move(output)});
  }
  return made;
}

Result<void> ReportOutput::write(const report::Page& page) {
  for (File& file : files_) {
    E2LF_ASSIGN_OR_RETURN(const std::string text, report::file_text(page, file.name));
    E2LF_RETURN_IF_ERROR(write_file(file.output.path(), text));
    E2LF_RETURN_IF_ERROR(file.output.commit());
  }
  return {};
}

report::Page verb_page(const std::string& title) {
  // The command line as it was typed, as far as possible.
  std::string command = "e2lf";
  for (const std::string& word : own_arguments()) command += " " + shell_word(word);
  report::Page page(title);
  page.code(command);
  return page;
}

}  // namespace e2lf::program
