// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/pipeline/event_run.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/outputs.h"

namespace e2lf::cli {

/// Declares the options that set up a live camera.
void add_camera_options(CLI::App& app, recordings::CameraSetup& camera);

/// The flags of every verb that reads a recording.
struct RecordingFlags {
  recordings::OpenOptions open;  ///< without what is_relative and is_strict determine
  bool is_relative = false;      ///< the time range is relative to the first event or trigger
  bool is_strict = false;        ///< data that would be dropped are an error
};

/// Declares --event-format, --sensor-width, --sensor-height, --stream, --columns, --time-unit, --polarities, --restart,
/// --from-us, --to-us, --relative and --strict, and the options of cameras.
void add_recording_options(CLI::App& app, RecordingFlags& flags);

/// Returns whether an input is live: "-", a camera, a socket or a named pipe.
[[nodiscard]] bool is_live(const std::filesystem::path& input);

/// Converts the flags to the options of a reader. Fails with kInvalidValue if they contradict each other, and for
/// --restart split if the caller does not call next_part().
[[nodiscard]] Result<recordings::OpenOptions> open_options(const std::filesystem::path& input,
                                                           const RecordingFlags& flags, bool reads_parts = false);

/// Opens a recording (a path, "-" for standard input, or the name of a camera), and logs what was assumed about it.
[[nodiscard]] Result<std::unique_ptr<recordings::RecordingReader>> open_recording(const std::filesystem::path& input,
                                                                                  const RecordingFlags& flags);

/// The flags of the verbs that divide a recording into pattern cycles.
struct CycleFlags {
  pipeline::CycleInputOptions events;  ///< without the input and the schedule; its callbacks are those of the caller
  std::filesystem::path schedule;
  RecordingFlags recording;
};

/// Declares all of CycleFlags; --transitions and --max-cycles also apply to event images.
void add_cycle_options(CLI::App& app, CycleFlags& flags);

/// Declares --fuse, the largest number of cycles in a mean; `result` is what the verb makes of each cycle.
void add_fuse_option(CLI::App& app, size_t& most_cycles, const char* result);

/// Opens a recording and divides it into cycles, of which those are wanted that `method` needs. The source "auto"
/// selects triggers if the recording begins with some, and bursts otherwise. Fails with kInvalidValue if the schedule
/// is the only source of times and --origin-us is missing.
[[nodiscard]] Result<cycles::CycleReader> open_cycles(const std::filesystem::path& input, const CycleFlags& flags,
                                                      const pipeline::MethodChoice& method = {});

/// Opens event images, another measurement, or a recording, and logs what was assumed about the latter, which is
/// divided into the cycles that `method` needs. Fails with kInvalidValue if flags for recordings are given for a
/// measurement, and as pipeline::CycleInput::open() does.
[[nodiscard]] Result<pipeline::CycleInput> open_cycle_input(const std::filesystem::path& input, const CycleFlags& flags,
                                                            const Verb& verb,
                                                            const pipeline::MethodChoice& method = {});

/// The flags of the verbs that reconstruct light fields.
struct MethodFlags {
  CodesSource codes;
  pipeline::MethodChoice choice;  ///< without the model, the patterns and the camera
  std::string gain = "auto", black = "auto", camera;
};

/// Declares -m, --codes, --camera, --precision and --device. `source` is what may state the camera.
void add_method_options(CLI::App& app, MethodFlags& flags, const std::string& source);

/// Declares --device.
void add_device_option(CLI::App& app, std::string& device);

/// Declares --gain and --black, for verbs whose output is a light field.
void add_tone_options(CLI::App& app, MethodFlags& flags);

/// Returns the choice with the model, the patterns and the camera that the flags name, and adds them to the record.
/// Fails as reading them does.
[[nodiscard]] Result<pipeline::MethodChoice> named_choice(const MethodFlags& flags, RunRecord& record);

/// Parses --gain (a positive number) and --black (a number of at least 0); "auto" leaves them to the method. Fails with
/// kInvalidValue.
[[nodiscard]] Result<pipeline::Tone> tone_of(const MethodFlags& flags);

/// Opens a run from the events of `input`, whose views are `turned` in addition. Fails as reading what the flags name
/// and EventRun::open() do.
[[nodiscard]] Result<pipeline::EventRun> open_event_run(const std::filesystem::path& input, const CycleFlags& cycles,
                                                        const MethodFlags& method, const OrientationFlags& turned,
                                                        const Verb& verb, RunRecord& record);

/// Logs which network was chosen by default, and records the decisions behind a method: the network or patterns that
/// were chosen by default, and the sources of the patterns and the sensor profile.
void record_method(const pipeline::OpenedMethod& method, RunRecord& record);

}  // namespace e2lf::cli
