// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/cli/flags/camera_flags.h"
#include "e2lf/files/options.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::cli {

/// The flags of every verb that reads a recording.
struct RecordingFlags {
  std::string format;                              ///< empty = detected
  size_t width = 0, height = 0;                    ///< px; 0 = as the recording says
  int64_t from_us = INT64_MIN, to_us = INT64_MAX;  ///< of the recording's clock
  std::string stream;                              ///< empty = the first
  std::string columns, time_unit = "auto";         ///< of tables
  std::string restart = "continue";                ///< what to do where the clock starts again
  bool is_relative = false;                        ///< they count from its first event or trigger
  bool is_strict = false;                          ///< what would be left out is an error
  CameraFlags camera;                              ///< of a live camera
};

/// The help group of options of recordings, where a verb takes other inputs too.
inline constexpr const char* kRecordingOptions = "Recordings";

/// Declares --event-format, --sensor-width, --sensor-height, --stream, --columns, --time-unit, --restart, --from-us,
/// --to-us, --relative and --strict.
void add_recording_options(CLI::App& app, RecordingFlags& flags, const std::string& group);

/// Whether an input is read as it arrives: "-", a camera, a socket, a named pipe.
[[nodiscard]] bool is_live(const std::filesystem::path& input);

/// What the flags ask of a reader. Fails with kInvalidValue where they contradict each other, and for --restart split
/// where the caller does not call next_part().
[[nodiscard]] Result<recordings::OpenOptions> open_options(const std::filesystem::path& input,
                                                           const RecordingFlags& flags, bool reads_parts = false);

/// Says on stderr what the recording does not tell and was taken for granted.
void say_assumptions(const recordings::RecordingReader& reader);

/// An assumption with the flag that says otherwise.
[[nodiscard]] std::string assumption_text(const recordings::Assumption& assumption);

/// How a table of events was read: {"columns", "time_unit", "polarity"}; null for other recordings.
[[nodiscard]] Json reading_json(const recordings::RecordingInfo& info);

/// The header of a recording: what the sensor is, and how a live camera was set.
[[nodiscard]] Json header_json(const recordings::RecordingInfo& info);

/// What the sensor itself counted: {"events_in", "events_sent"}; null where it did not.
[[nodiscard]] Json sensor_json(const recordings::DecodeSummary& summary);

/// What was left out of a recording, by reason: [{"reason", "count", "first_byte"}, ...].
[[nodiscard]] Json losses_json(const recordings::DecodeSummary& summary);

/// How far processing fell behind live input: {"most_behind_s", "pauses",
/// "may_have_lost_events", "dropped_bytes", "failure"}; null for what is not
/// live.
[[nodiscard]] Json live_json(const recordings::DecodeSummary& summary);

/// The places where the clock starts again: [{"byte", "before_us", "after_us", "shift_us"}, ...].
[[nodiscard]] Json restarts_json(const recordings::DecodeSummary& summary);

/// Says on stderr, with --quiet too, what was left out, where the clock started again, and that processing fell
/// behind live input; nothing when nothing was. To
/// be called also before a verb fails for want of events.
void warn_of_losses(const std::filesystem::path& input, const recordings::DecodeSummary& summary);

/// ", 20 of them sorted to their place"; empty when all were in order.
[[nodiscard]] std::string sorted_text(const recordings::DecodeSummary& summary);

}  // namespace e2lf::cli
