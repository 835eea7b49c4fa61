// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "e2lf/cli/flags/cycle_options.h"
#include "e2lf/cli/flags/method_flags.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/pipeline/event_run.h"
#include "e2lf/program/run_record.h"

namespace e2lf::cli {

/// Reads what the flags of a verb name, and opens a run with the remaining `options`. Fails as reading them and
/// EventRun::open() do.
[[nodiscard]] Result<pipeline::EventRun> open_event_run(const std::filesystem::path& input, const CycleFlags& cycles,
                                                        const MethodFlags& method, pipeline::EventRunOptions options,
                                                        const Verb& verb, RunRecord& record);

/// Logs the course of a run from events, and converts it to JSON for the record.
class EventRunLog {
 public:
  /// Logs and records how the run was opened.
  EventRunLog(const pipeline::EventRun& run, std::filesystem::path input, RunRecord& record);

  /// Logs what was found of a result that is complete, and returns what the record states of it, apart from its files.
  [[nodiscard]] Json add(const pipeline::EventResult& result);

  /// Logs and records what the whole run found and left out, and returns it for --json: {"left_out", "findings"}. Fails
  /// if a recording contained no complete cycle.
  [[nodiscard]] Result<Json> finish(const Verb& verb, RunRecord& record);

 private:
  const pipeline::EventRun& run_;
  std::filesystem::path input_;
  LiveLog live_;
  size_t warned_ = 0;
};

/// Returns a line on the difference between the events of a cycle and those that its light field would cause, with the
/// verdict; empty if they were not compared.
[[nodiscard]] std::string event_error_text(const pipeline::EventResult& result);

}  // namespace e2lf::cli
