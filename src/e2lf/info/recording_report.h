// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "e2lf/base/choice.h"
#include "e2lf/base/result.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/diagnose/rig.h"
#include "e2lf/files/options.h"
#include "e2lf/recordings/recording.h"

/// Reports of the cycles that were found in a recording.
namespace e2lf::info {

inline constexpr Choice<cycles::CycleSource> kCycleSources[] = {{"auto", cycles::CycleSource::kAuto},
                                                                {"triggers", cycles::CycleSource::kTriggers},
                                                                {"bursts", cycles::CycleSource::kBursts},
                                                                {"schedule", cycles::CycleSource::kSchedule}};

/// Returns one line of text: the number of cycles that were found and dropped, with the reasons.
[[nodiscard]] std::string report_text(const cycles::CycleReport& report);
/// Returns the error for a recording without a complete cycle, with advice.
[[nodiscard]] Error no_cycle_error(const std::filesystem::path& input, const diagnose::RigCheck& rig,
                                   const cycles::CycleReader& reader);

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

/// Reports of a recording that was read.
namespace e2lf::info {

/// Logs what the recording does not state and was therefore assumed.
void log_assumptions(const recordings::RecordingReader& reader);

/// Returns the text of an assumption with the setting that overrides it.
[[nodiscard]] std::string assumption_text(const recordings::Assumption& assumption);

/// Returns how a table of events was read: {"columns", "time_unit", "polarity"}; null for other recordings.
[[nodiscard]] Json reading_json(const recordings::RecordingInfo& info);

/// Returns the header of a recording: the identity of the sensor, and the settings of a live camera.
[[nodiscard]] Json header_json(const recordings::RecordingInfo& info);

/// Returns the notes for the record on how a recording was read: "read_as", and "header" of a live input.
[[nodiscard]] Json reading_notes(const std::filesystem::path& input, const recordings::RecordingInfo& info);

/// Returns the counts of the sensor itself: {"events_in", "events_sent"}; null if it reported none.
[[nodiscard]] Json sensor_json(const recordings::DecodeSummary& summary);

/// Returns the data that were dropped from a recording, by reason: [{"reason", "count", "first_byte"}, ...].
[[nodiscard]] Json losses_json(const recordings::DecodeSummary& summary);

/// Returns by how much processing was behind live input, and what ended that: {"most_behind_s", "pauses",
/// "may_have_lost_events", "dropped_bytes", "failure"}; null if the input is not live.
[[nodiscard]] Json live_json(const recordings::DecodeSummary& summary);

/// Returns the positions at which the clock starts again: [{"byte", "before_us", "after_us", "shift_us"}, ...].
[[nodiscard]] Json restarts_json(const recordings::DecodeSummary& summary);

/// Logs, even with --quiet, which data were dropped, where the clock started again, and whether processing was behind
/// live input; nothing if none of this happened. Should also be called before a verb fails for lack of events.
void warn_of_losses(const std::filesystem::path& input, const recordings::DecodeSummary& summary);

/// Returns ", 20 of them sorted to their place", or an empty string if all events were in order.
[[nodiscard]] std::string sorted_text(const recordings::DecodeSummary& summary);

/// Returns counts, times, and the data that were dropped.
[[nodiscard]] Json summary_json(const recordings::DecodeSummary& summary);

}  // namespace e2lf::info
