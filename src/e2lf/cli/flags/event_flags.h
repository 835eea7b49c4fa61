// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/pipeline/cycle_input.h"
#include "e2lf/pipeline/field_sequence.h"
#include "e2lf/pipeline/method.h"
#include "e2lf/program/inputs.h"
#include "e2lf/program/outputs.h"
#include "e2lf/recordings/recording.h"

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

/// The flags of the verbs that divide a recording into pattern cycles.
struct CycleFlags {
  cycles::CycleOptions options;     ///< without the schedule; its callbacks are those of the caller
  pipeline::ScheduleChoice choice;  ///< without the schedule
  std::filesystem::path schedule;
  std::optional<int64_t> origin_us;
  uint64_t max_cycles = 0;  ///< 0 = all
  RecordingFlags recording;
};

/// Declares all of CycleFlags; --transitions and --max-cycles also apply to event images.
void add_cycle_options(CLI::App& app, CycleFlags& flags);

/// Declares --fuse, the largest number of cycles in a mean; `result` is what the verb makes of each cycle.
void add_fuse_option(CLI::App& app, size_t& most_cycles, const char* result);

/// Returns the options of the pipeline for these flags, and reads the schedule that they name. Fails as
/// cycles::read_schedule() does.
[[nodiscard]] Result<pipeline::CycleInputOptions> cycle_input_options(const std::filesystem::path& input,
                                                                      const CycleFlags& flags);

/// Opens a recording (a path, "-" for standard input, or the name of a camera) and divides it into cycles. The source
/// "auto" selects triggers if the recording begins with some, and bursts otherwise. Fails with kInvalidValue if the
/// schedule is the only source of times and --origin-us is missing.
[[nodiscard]] Result<cycles::CycleReader> open_cycles(const std::filesystem::path& input, const CycleFlags& flags);

/// Opens event images, another measurement, or a recording, and logs what was assumed about the latter. Fails with
/// kInvalidValue if flags for recordings are given for a measurement.
[[nodiscard]] Result<pipeline::EventSource> open_events(const std::filesystem::path& input, const CycleFlags& flags,
                                                        const Verb& verb);

/// Opens these and divides a recording into cycles. Fails as open_events() and pipeline::CycleInput::open() do.
[[nodiscard]] Result<pipeline::CycleInput> open_cycle_input(const std::filesystem::path& input, const CycleFlags& flags,
                                                            const Verb& verb);

/// The flags of the verbs that reconstruct light fields.
struct MethodFlags {
  CodesSource codes;
  std::string precision = "auto", device = "cpu", gain = "auto", black = "auto", camera;
};

/// Declares -m, --codes, --camera, --precision and --device. `source` is what may state the camera.
void add_method_options(CLI::App& app, MethodFlags& flags, const std::string& source);

/// Declares --device.
void add_device_option(CLI::App& app, std::string& device);

/// Declares --gain and --black, for verbs whose output is a light field.
void add_tone_options(CLI::App& app, MethodFlags& flags);

/// Reads the model, the patterns and the camera that the flags name, adds them to the record, and takes over the
/// precision and the device. Fails as reading them does.
[[nodiscard]] Result<pipeline::MethodChoice> named_choice(const MethodFlags& flags, RunRecord& record);

/// Parses --gain (a positive number) and --black (a number of at least 0); "auto" leaves them to the method. Fails with
/// kInvalidValue.
[[nodiscard]] Result<pipeline::Tone> tone_of(const MethodFlags& flags);

/// Logs which network was chosen by default, and records the decisions behind a method: the network or patterns that
/// were chosen by default, and the sources of the patterns and the sensor profile. `passes` is the requested number of
/// passes.
void record_method(const pipeline::OpenedMethod& method, size_t passes, RunRecord& record);

}  // namespace e2lf::cli
