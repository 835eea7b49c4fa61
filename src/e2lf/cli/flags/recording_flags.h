// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/base/result.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::cli {

/// The flags that set up a live camera; see recordings::CameraSetup.
struct CameraFlags {
  std::vector<std::string> trigger_channels, regions;
  std::filesystem::path biases;
  std::optional<uint32_t> max_events_per_s;
  std::string encoding;
  bool switches_filters_off = false;
  std::shared_ptr<recordings::RunningCamera> running;  ///< set by verbs that change settings while the camera runs
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

}  // namespace e2lf::cli
