// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "e2lf/capture/measurement/measurement.h"
#include "e2lf/cycles/marks.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::cycles {

/// The source of the times at which patterns change.
enum class CycleSource {
  kTriggers,  ///< an external trigger for each pattern or for each cycle
  kSchedule,  ///< the schedule alone, from a known time on
  kBursts,    ///< the events themselves
  kAuto,      ///< triggers if the recording begins with some, otherwise bursts
};

enum class TriggerEdge { kRising, kFalling, kBoth };

/// The names of the edges in options.
inline constexpr Choice<TriggerEdge> kTriggerEdges[] = {
    {"rising", TriggerEdge::kRising}, {"falling", TriggerEdge::kFalling}, {"both", TriggerEdge::kBoth}};

/// Returns whether a trigger is of the channel (absent = any) and has the edge.
[[nodiscard]] inline bool is_of(const recordings::Trigger& trigger, std::optional<uint16_t> channel, TriggerEdge edge) {
  return (!channel || trigger.id == *channel) &&
         (edge == TriggerEdge::kBoth || (trigger.p != 0) == (edge == TriggerEdge::kRising));
}

struct CycleOptions {
  CycleSource source = CycleSource::kAuto;
  Schedule schedule = paper_schedule();

  bool invert_polarity = false;  ///< exchanges ON and OFF of the recording

  TriggerEdge edge = TriggerEdge::kRising;
  std::optional<uint16_t> channel = {};  ///< channel of the triggers; absent = all channels
  bool one_trigger_per_cycle = false;    ///< the trigger marks the start of the first pattern of a cycle
  int64_t trigger_delay_us = 0;          ///< from a trigger to the change of the pattern; negative if it comes first
  TrackerOptions tracker = {};           ///< for triggers and bursts

  int64_t origin_us = 0;  ///< kSchedule: the time at which the first pattern of any cycle began

  /// Called with every batch that is read and every mark that is found, e.g. to plot a recording.
  std::function<void(const recordings::EventBatch&)> on_batch = {};
  std::function<void(const Mark&)> on_mark = {};

  bool filters_pixels = false;  ///< gives hot pixels the counts of their neighbours

  /// The number of events that may wait until their pattern is known. If it is exceeded, the oldest ones are dropped.
  size_t max_waiting_events = size_t{1} << 26;
};

/// The times t with begin_us <= t < end_us.
struct TimeSlice {
  int64_t begin_us = 0;
  int64_t end_us = 0;
};

/// The numbers of events from the change to a pattern until the next change.
struct PatternEvents {
  uint64_t on = 0, off = 0;
};

/// One pass over the patterns.
struct Cycle {
  uint64_t number = 0;                        ///< in the recording, including dropped cycles
  int64_t begin_us = 0;                       ///< start of its first pattern
  int64_t end_us = 0;                         ///< end of its last pattern
  std::vector<PatternStart> starts;           ///< of all patterns, in order
  std::vector<TimeSlice> slices;              ///< intervals of the event images
  std::vector<PatternEvents> pattern_events;  ///< one for each pattern of the schedule; empty unless all were read
  capture::EventImages images;
  uint64_t events = 0;     ///< in the images
  uint64_t saturated = 0;  ///< number of events for which the images had no room
  /// The confidence, according to the events, that the patterns changed at the stated times, for the least certain one.
  float confidence = 1.0F;

  int64_t known_us = 0;  ///< the time up to which the recording had been read when the cycle was complete
  /// The arrival of the bytes that completed the cycle; absent if the recording is not live. The delay from the end of
  /// its last pattern to any result is (known_us - slices.back().end_us) plus the time since `arrival`.
  std::optional<std::chrono::steady_clock::time_point> arrival = {};
};

/// The reason why a cycle was dropped.
enum class CycleFault {
  kMissing,  ///< a transition is missing
  kDoubled,  ///< there is an additional transition
  kLost,     ///< the transitions no longer follow the schedule
  kPartial,  ///< the recording begins or ends within it
};
inline constexpr size_t kNumCycleFaults = 4;

/// The names of the faults in reports, in the order of their values.
inline constexpr Choice<CycleFault> kCycleFaults[kNumCycleFaults] = {{"missing", CycleFault::kMissing},
                                                                     {"doubled", CycleFault::kDoubled},
                                                                     {"lost", CycleFault::kLost},
                                                                     {"partial", CycleFault::kPartial}};

struct DroppedCycle {
  uint64_t number = 0;
  int64_t begin_us = 0;
  CycleFault fault = CycleFault::kMissing;
};

struct CycleReport {
  uint64_t complete = 0;
  std::array<uint64_t, kNumCycleFaults> dropped{};
  std::vector<DroppedCycle> drops;  ///< the first kMaxDrops
  uint64_t marks = 0;               ///< triggers of the channel and edge, or bursts
  uint64_t unassigned_marks = 0;    ///< marks whose pattern could not be determined
  bool has_assumed_first = false;   ///< intervals and events did not determine the pattern of the first trigger
  uint64_t events_given_up = 0;     ///< because they waited too long
  uint64_t hot_pixels = 0;          ///< that the filter currently replaces

  static constexpr size_t kMaxDrops = 1000;
};

/// Returns the name of the option that determines with which pattern a cycle begins: that of the first pattern counts
/// from where triggers or bursts of each pattern begin.
[[nodiscard]] const char* option_of_first_pattern(const CycleOptions& options);

/// Divides a recording into cycles and accumulates each into event images. Memory is bounded by the images of one
/// cycle, one batch, and the events whose pattern is not yet known: those of a few milliseconds, or of one cycle at the
/// beginning.
class CycleReader {
 public:
  static constexpr double kMostHotShare = 0.02;

  /// Fails with kInvalidValue: an invalid schedule, a first pattern that does not exist, or a sensor of unknown size
  /// (which must then be given to the reader). With kAuto, the first two cycle times of the recording are read in
  /// advance.
  [[nodiscard]] static Result<CycleReader> open(std::unique_ptr<recordings::RecordingReader> reader,
                                                const CycleOptions& options);

  CycleReader(CycleReader&&) noexcept;
  CycleReader& operator=(CycleReader&&) noexcept;
  ~CycleReader();

  /// Reads only every `cycles`-th cycle completely. Of the others, the events that no image needs are skipped if the
  /// format permits it (recordings::RecordingReader::skip_events). The images do not change. Skipped cycles have the
  /// confidence of the last complete one. With 1, the default, all events are read. Has an effect only if there is a
  /// trigger for each pattern.
  void read_whole_every(uint64_t cycles);

  /// Returns the next complete cycle, or nothing at the end. Incomplete cycles are dropped and reported. Fails as the
  /// reader does and, under its strict policy, also if an image has no room for an event, and with kInvalidValue if the
  /// filter finds more hot pixels than a sensor has (kMostHotShare).
  [[nodiscard]] Result<std::optional<Cycle>> next();

  [[nodiscard]] CycleReport report() const;

  /// Returns what was left out of the recording and of the images of complete cycles.
  [[nodiscard]] recordings::DecodeSummary summary() const;

  /// Returns the options in use, whose source is never kAuto.
  [[nodiscard]] const CycleOptions& options() const;
  [[nodiscard]] CycleSource source() const { return options().source; }
  [[nodiscard]] const recordings::RecordingReader& recording() const;
  [[nodiscard]] const Schedule& schedule() const { return options().schedule; }

 private:
  class Impl;
  explicit CycleReader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace e2lf::cycles
