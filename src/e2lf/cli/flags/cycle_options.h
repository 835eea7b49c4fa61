// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "e2lf/base/result.h"
#include "e2lf/cli/flags/recording_flags.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/files/options.h"

namespace e2lf::cli {

/// The flags of the verbs that cut a recording into pattern cycles.
struct CycleFlags {
  std::string source = "auto", edge = "rising";
  std::filesystem::path schedule;
  std::optional<size_t> num_patterns;  ///< for the paper's schedule; nothing = as many as the recording says, else 4
  std::optional<uint16_t> channel;
  std::optional<size_t> first_pattern;
  std::string transitions = "auto";
  size_t usual_patterns = 4;         ///< for the paper's schedule where nothing else says how many
  std::optional<size_t> num_wanted;  ///< patterns whose transitions the network takes; "auto" goes by it
  bool one_trigger_per_cycle = false, filter_pixels = false, invert_polarity = false;
  std::optional<int64_t> origin_us;
  uint64_t max_cycles = 0;  ///< 0 = all
  RecordingFlags recording;
};

/// Sees what a reader of cycles reads and finds; see cycles::CycleOptions.
struct CycleObserver {
  std::function<void(const recordings::EventBatch&)> on_batch = {};
  std::function<void(const cycles::Mark&)> on_mark = {};
};

/// The help group of the options that only recordings know.
inline constexpr const char* kCycleOptions = "Pattern cycles of a recording";

/// Declares all of CycleFlags; --max-cycles is for event images too.
void add_cycle_options(CLI::App& app, CycleFlags& flags);

/// What the flags say of cycles of a schedule; --schedule and --patterns, and the flags of the recording, are left
/// aside. Fails with kInvalidValue where the schedule alone shall tell and nothing says when it began.
[[nodiscard]] Result<cycles::CycleOptions> cycle_options(const CycleFlags& flags, cycles::Schedule schedule);

/// Opens a recording (a path, "-" for standard input, or a camera's name) cut into cycles as the flags say.
/// "auto" takes triggers when the recording begins with some, else bursts.
[[nodiscard]] Result<cycles::CycleReader> open_cycles(const std::filesystem::path& input, const CycleFlags& flags,
                                                      const CycleObserver& observer = {});

/// Watches whether the events confirm what was claimed of the cycles.
class ConfidenceWatch {
 public:
  void add(const cycles::Cycle& cycle, cycles::CycleSource source);
  [[nodiscard]] float least() const { return least_; }
  /// Warns of cycles in whose claimed changes nothing happens, or the opposite, of inverted polarity, of triggers that
  /// are out of step, and of what had to be assumed.
  void warn(const std::filesystem::path& input, const cycles::CycleReport& report,
            const cycles::Schedule& schedule) const;

 private:
  float least_ = 1.0F;
  uint64_t cycles_ = 0, doubtful_ = 0;
  bool is_by_schedule_ = false;
};

/// What --source calls it.
[[nodiscard]] const char* source_name(cycles::CycleSource source);

/// One line for people: cycles found and dropped, and why.
[[nodiscard]] std::string report_text(const cycles::CycleReport& report);
/// The error of a recording in which nothing was found.
[[nodiscard]] Error no_cycle_error(const std::filesystem::path& input, const cycles::CycleReport& report);
[[nodiscard]] Json report_json(const cycles::CycleReport& report);

/// One cycle: number, times, events, confidence.
[[nodiscard]] Json cycle_json(const cycles::Cycle& cycle);

}  // namespace e2lf::cli
