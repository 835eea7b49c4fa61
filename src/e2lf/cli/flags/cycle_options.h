// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/cli/flags/recording_flags.h"
#include "e2lf/cli/verbs.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/diagnose/rig.h"
#include "e2lf/info/recording_report.h"
#include "e2lf/pipeline/cycle_input.h"
#include "e2lf/pipeline/method.h"
#include "e2lf/program/option_values.h"

namespace e2lf::cli {

inline constexpr Choice<cycles::CycleSource> kCycleSources[] = {{"auto", cycles::CycleSource::kAuto},
                                                                {"triggers", cycles::CycleSource::kTriggers},
                                                                {"bursts", cycles::CycleSource::kBursts},
                                                                {"schedule", cycles::CycleSource::kSchedule}};
inline constexpr Choice<cycles::TriggerEdge> kTriggerEdges[] = {{"rising", cycles::TriggerEdge::kRising},
                                                                {"falling", cycles::TriggerEdge::kFalling},
                                                                {"both", cycles::TriggerEdge::kBoth}};

/// The flags of the verbs that divide a recording into pattern cycles.
struct CycleFlags {
  std::string source = "auto", edge = "rising";
  std::filesystem::path schedule;
  std::optional<size_t>
      num_patterns;  ///< number of coding patterns of the paper's schedule; empty = as the recording states, or else 4
  std::optional<uint16_t> channel;
  std::optional<size_t> first_pattern;
  std::string transitions = "auto";
  size_t usual_patterns = 4;         ///< number of patterns of the paper's schedule if nothing else states it
  std::optional<size_t> num_wanted;  ///< number of patterns of the network; determines transitions "auto"
  bool one_trigger_per_cycle = false, filter_pixels = false, invert_polarity = false;
  std::optional<int64_t> origin_us;
  int64_t trigger_delay_us = 0;
  uint64_t max_cycles = 0;  ///< 0 = all
  RecordingFlags recording;
};

/// Callbacks for the batches that a reader of cycles reads and the marks that it finds; see cycles::CycleOptions.
struct CycleObserver {
  std::function<void(const recordings::EventBatch&)> on_batch = {};
  std::function<void(const cycles::Mark&)> on_mark = {};
};

/// The help group of the options that only apply to recordings.
inline constexpr const char* kCycleOptions = "Pattern cycles of a recording";

/// Declares all of CycleFlags; --transitions and --max-cycles also apply to event images.
void add_cycle_options(CLI::App& app, CycleFlags& flags);

/// Converts the flags to the options of a reader of cycles with this schedule, ignoring --schedule, --patterns and the
/// flags of the recording. Fails with kInvalidValue if the schedule is the only source of times and --origin-us is
/// missing.
[[nodiscard]] Result<cycles::CycleOptions> cycle_options(const CycleFlags& flags, cycles::Schedule schedule);

/// Opens a recording (a path, "-" for standard input, or the name of a camera) and divides it into cycles. The source
/// "auto" selects triggers if the recording begins with some, and bursts otherwise.
[[nodiscard]] Result<cycles::CycleReader> open_cycles(const std::filesystem::path& input, const CycleFlags& flags,
                                                      const CycleObserver& observer = {});

/// Opens event images, another measurement, or a recording, which is passed to `rig`. Fails as
/// CycleInput::create() does, and with kInvalidValue if flags for recordings are given for a measurement.
[[nodiscard]] Result<pipeline::CycleInput> open_cycle_input(const std::filesystem::path& input, const CycleFlags& flags,
                                                            size_t cycles_per_field, const Verb& verb,
                                                            diagnose::RigCheck& rig);

/// Sets the number of patterns that the cycles of a recording must have for the model or patterns of the caller.
[[nodiscard]] CycleFlags wanted_cycles(CycleFlags flags, const pipeline::MethodChoice& choice);

/// Converts an error of the pipeline for the user: replaces the option in its location by the flag, or an empty
/// location by the input.
[[nodiscard]] Error by_flag(Error error, const std::filesystem::path& input);
template <typename T>
[[nodiscard]] Result<T> by_flag(Result<T> result, const std::filesystem::path& input) {
  if (!result) return by_flag(result.error(), input);
  return result;
}

}  // namespace e2lf::cli
