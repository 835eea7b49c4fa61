// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/diagnose/rig.h"
#include "e2lf/files/options.h"

/// What is said of the cycles that were found in a recording.
namespace e2lf::info {

/// Returns "triggers", "bursts", "schedule" or "auto".
[[nodiscard]] const char* source_name(cycles::CycleSource source);

/// Returns one line of text: the number of cycles that were found and dropped, with the reasons.
[[nodiscard]] std::string report_text(const cycles::CycleReport& report);
/// Returns the error for a recording without a complete cycle, with advice.
[[nodiscard]] Error no_cycle_error(const std::filesystem::path& input, const diagnose::RigCheck& rig,
                                   const cycles::CycleReader& reader);
/// Returns the cycles found and dropped, and what may be wrong with the rig.
[[nodiscard]] Json report_json(const diagnose::RigCheck& rig, const cycles::CycleReader& reader);

/// Returns a cycle as JSON: number, times, events, confidence.
[[nodiscard]] Json cycle_json(const cycles::Cycle& cycle);

/// Logs the progress of live input, whose end is not known: one line for each completed cycle, and totals at the end.
/// Independent of whether stderr is a terminal; silent with --quiet.
class LiveLog {
 public:
  /// Logs a completed cycle; `latency_s` is the time since the end of its last pattern.
  void add(uint64_t cycle, uint64_t events, double latency_s);
  /// Logs the totals at the end of the input. Does nothing if add() was never called.
  void finish(const cycles::CycleReport& report) const;

 private:
  uint64_t cycles_ = 0, events_ = 0;
  double sum_s_ = 0, most_s_ = 0;
};

}  // namespace e2lf::info
