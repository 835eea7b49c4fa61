// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/options.h"
#include "e2lf/files/output.h"
#include "e2lf/files/result_folder.h"
#include "e2lf/program/verb.h"
#include "e2lf/recordings/open/registry.h"
#include "e2lf/report/page.h"

namespace e2lf::program {

/// The record of a run: verb, version, resolved options, seed, SHA-256 of every input, and timings. It is written as
/// run.json beside the results, so that any result can be reproduced.
class RunRecord {
 public:
  explicit RunRecord(const Verb& verb, const std::vector<std::filesystem::path>& inputs = {});

  /// Adds an input file, or every file of an input folder. Other inputs (a pipe, a camera) have no hash and are
  /// omitted.
  void add_input(const std::filesystem::path& path);

  /// Adds an input file whose content was already read, and hashes it at once.
  void add_input(const std::filesystem::path& path, std::span<const uint8_t> bytes);

  /// Ends the step that began at construction or at the last call, for the timings.
  void end_step(const std::string& name);

  /// Stores a result or an estimate, e.g. the gain that was chosen.
  void note(const std::string& key, Json value) { notes_[key] = std::move(value); }
  void note(const Json& notes) { notes_.update(notes); }

  /// Stores the value that was chosen for an option whose setting leaves it open (a default of the model, "auto"), so
  /// that the run can be repeated from its record.
  void resolve(const std::string& option, Json value) { determined_[option] = std::move(value); }

  /// Returns the record, which ResultFolder writes as run.json. Reads the inputs, and warns of those that have changed
  /// since the run that is repeated.
  [[nodiscard]] Result<Json> json() const;

  /// Returns the record of a result that is not complete, without inputs and results.
  [[nodiscard]] Json json_so_far() const;

  /// Writes the record beside a single file, to OutputFile::record_path().
  [[nodiscard]] Result<void> write(const std::filesystem::path& path) const;

 private:
  using Clock = std::chrono::steady_clock;
  const Verb* verb_;
  struct Input {
    std::filesystem::path path;
    std::string sha256;  ///< empty if it was not read yet
  };
  std::vector<Input> inputs_;
  Json timings_s_ = Json::object();
  Json notes_ = Json::object();
  Json determined_ = Json::object();
  Clock::time_point step_begin_ = Clock::now();
};

/// Return the rules for an output of a verb, which replaces none of Verb::named_inputs(), of which the main one is the
/// first, and of the inputs that no option names, `more`; see the functions of `recordings` with the same names.
[[nodiscard]] OutputRules recording_output_rules(const Verb& verb, const recordings::Codec& codec);
[[nodiscard]] OutputRules output_rules(const Verb& verb, const std::vector<std::filesystem::path>& more = {});

/// Open a file, whose name ends with `ending`, and a folder for results. Fail as OutputFile::create() and
/// open_result_folder() do.
[[nodiscard]] Result<OutputFile> open_output(const std::filesystem::path& named, const Verb& verb,
                                             std::string ending = {},
                                             const std::vector<std::filesystem::path>& more = {});
[[nodiscard]] Result<ResultFolder> open_output_folder(const std::filesystem::path& named, const Verb& verb,
                                                      const std::vector<std::filesystem::path>& more = {});

/// Complete the result of a run with its record and move both to their place. A stream has no record. Fail as
/// RunRecord::json() and the result's own commit() do.
[[nodiscard]] Result<void> commit(OutputFile& output, const RunRecord& record);
[[nodiscard]] Result<void> commit(ResultFolder& folder, const RunRecord& record);

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
