// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/capture/patterns/codes.h"
#include "e2lf/cli/output/output.h"
#include "e2lf/lightfield/image.h"
#include "e2lf/report/page.h"

namespace e2lf::cli {

/// Declares --report: files that tell of the run, a page (.html) or its tables (.csv, .tex).
void add_report_option(CLI::App& app, std::vector<std::filesystem::path>& names);

/// The files of --report.
class ReportOutput {
 public:
  /// Checks all places before any work. Fails as OutputFile::create() does.
  [[nodiscard]] static Result<ReportOutput> open(const std::vector<std::filesystem::path>& names,
                                                 const OutputRules& rules);
  [[nodiscard]] bool is_wanted() const { return !files_.empty(); }
  /// Fails with kIo, and as OutputFile::commit().
  [[nodiscard]] Result<void> write(const report::Page& page);

 private:
  struct File {
    report::FileFormat format;
    OutputFile output;
  };
  std::vector<File> files_;
};

/// A page for a verb: its title, and the command line.
[[nodiscard]] report::Page verb_page(const std::string& title);

/// Pictures for a page, each with its caption; wide ones are shrunk to `most_width`. Fails as encode_png() does.
struct NamedImage {
  lightfield::Image image;
  std::string caption;
};
[[nodiscard]] Result<void> add_pictures(const std::vector<NamedImage>& images, size_t most_width, report::Page& page);

/// Patterns side by side, numbered.
void add_patterns(const capture::Codes& codes, report::Page& page);

/// Events per pixel of each transition as bars.
[[nodiscard]] std::string transition_bars(const std::vector<double>& events_per_pixel);

/// A chart as a file of its own; `name` says by its extension whether it is SVG or PNG, `place` is where it is written.
/// Fails as film::draw_svg(), and with kIo.
[[nodiscard]] Result<void> write_chart(const std::string& svg, const std::filesystem::path& name,
                                       const std::filesystem::path& place);

/// Accepts names that end in .svg or .png.
[[nodiscard]] CLI::Validator chart_name();

}  // namespace e2lf::cli
