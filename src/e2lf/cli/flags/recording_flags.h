// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/files/options.h"
#include "e2lf/recordings/camera_setup.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::cli {

/// The flags that set up a live camera; see recordings::CameraSetup.
struct CameraFlags {
  std::vector<std::string> trigger_channels, regions;
  std::filesystem::path biases;
  std::optional<uint32_t> max_events_per_s;
  std::string encoding;
  bool switches_filters_off = false;
};

void add_camera_options(CLI::App& app, CameraFlags& flags);

/// Returns the settings of a camera. Fails with kInvalidValue if a region is not of the form X,Y,WIDTH,HEIGHT.
[[nodiscard]] Result<recordings::CameraSetup> camera_setup(const CameraFlags& flags);

/// The flags of every verb that reads a recording.
struct RecordingFlags {
  std::string format;                              ///< empty = detected
  size_t width = 0, height = 0;                    ///< px; 0 = as the recording states
  int64_t from_us = INT64_MIN, to_us = INT64_MAX;  ///< time range on the recording's clock
  std::string stream;                              ///< number or name; empty = the first
  std::string columns, time_unit = "auto";         ///< columns and unit of time of tables
  std::string polarities;                          ///< numbers of OFF and ON in tables
  std::string restart = "continue";                ///< how to treat a restart of the clock
  bool is_relative = false;                        ///< the time range is relative to the first event or trigger
  bool is_strict = false;                          ///< data that would be dropped are an error
  CameraFlags camera;                              ///< settings of a live camera
};

/// The help group of the options of recordings, for verbs that also accept other inputs.
inline constexpr const char* kRecordingOptions = "Recordings";

/// Declares --event-format, --sensor-width, --sensor-height, --stream, --columns, --time-unit, --polarities, --restart,
/// --from-us,
/// --to-us, --relative and --strict.
void add_recording_options(CLI::App& app, RecordingFlags& flags, const std::string& group);

/// Returns whether an input is live: "-", a camera, a socket or a named pipe.
[[nodiscard]] bool is_live(const std::filesystem::path& input);

/// Converts the flags to the options of a reader. Fails with kInvalidValue if they contradict each other, and for
/// --restart split if the caller does not call next_part().
[[nodiscard]] Result<recordings::OpenOptions> open_options(const std::filesystem::path& input,
                                                           const RecordingFlags& flags, bool reads_parts = false);

/// Logs what the recording does not state and was therefore assumed.
void say_assumptions(const recordings::RecordingReader& reader);

/// Returns the text of an assumption with the flag that overrides it.
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

}  // namespace e2lf::cli
