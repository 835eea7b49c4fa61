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

/// The flags of the verbs that divide a recording into pattern cycles.
struct CycleFlags {
  std::string source = "auto", edge = "rising";
  std::filesystem::path schedule;
  std::optional<size_t> num_patterns;  ///< for the paper's schedule; empty = as the recording states, or else 4
  std::optional<uint16_t> channel;
  std::optional<size_t> first_pattern;
  std::string transitions = "auto";
  size_t usual_patterns = 4;         ///< number of patterns of the paper's schedule if nothing else states it
  std::optional<size_t> num_wanted;  ///< number of patterns of the network; determines transitions "auto"
  bool one_trigger_per_cycle = false, filter_pixels = false, invert_polarity = false;
  std::optional<int64_t> origin_us;
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

/// Returns whether the events hardly confirm the times of a cycle.
[[nodiscard]] bool is_doubtful(const cycles::Cycle& cycle, cycles::CycleSource source);

/// Collects how well the events confirm the times of the cycles.
class ConfidenceWatch {
 public:
  void add(const cycles::Cycle& cycle, cycles::CycleSource source);
  [[nodiscard]] float least() const { return least_; }
  /// Warns about cycles whose stated changes of pattern the events do not confirm or contradict, about inverted
  /// polarity and triggers that are out of step, and about assumptions.
  void warn(const std::filesystem::path& input, const cycles::CycleReport& report,
            const cycles::Schedule& schedule) const;

 private:
  float least_ = 1.0F;
  uint64_t cycles_ = 0, doubtful_ = 0;
  bool is_by_schedule_ = false;
};

/// Returns the value of --source for a source.
[[nodiscard]] const char* source_name(cycles::CycleSource source);

/// Returns one line of text: the number of cycles that were found and dropped, with the reasons.
[[nodiscard]] std::string report_text(const cycles::CycleReport& report);
/// Returns the error for a recording without a complete cycle, with advice.
[[nodiscard]] Error no_cycle_error(const std::filesystem::path& input, const cycles::CycleReport& report);
[[nodiscard]] Json report_json(const cycles::CycleReport& report);

/// Returns a cycle as JSON: number, times, events, confidence.
[[nodiscard]] Json cycle_json(const cycles::Cycle& cycle);

}  // namespace e2lf::cli
