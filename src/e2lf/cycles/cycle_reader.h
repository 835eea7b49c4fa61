// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "e2lf/cycles/burst_detector.h"
#include "e2lf/cycles/late_edges.h"
#include "e2lf/cycles/mark_signer.h"
#include "e2lf/cycles/onset_check.h"
#include "e2lf/cycles/pattern_tracker.h"
#include "e2lf/cycles/pixel_filter.h"
#include "e2lf/cycles/polarity_check.h"
#include "e2lf/cycles/schedule.h"
#include "e2lf/cycles/trigger_survey.h"
#include "e2lf/recordings/recording.h"

namespace e2lf::cycles {

/// What tells when patterns change.
enum class CycleSource {
  kTriggers,  ///< an external trigger for each pattern, or for each cycle
  kSchedule,  ///< the schedule alone, from one known time on
  kBursts,    ///< the events themselves
  kAuto,      ///< triggers where the recording begins with some of the channel and edge, otherwise bursts
};

enum class TriggerEdge { kRising, kFalling, kBoth };

struct CycleOptions {
  CycleSource source = CycleSource::kBursts;
  Schedule schedule = paper_schedule();

  bool invert_polarity = false;  ///< ON and OFF of the recording change places

  TriggerEdge edge = TriggerEdge::kRising;
  std::optional<uint16_t> channel = {};  ///< of the triggers; nothing = all
  bool one_trigger_per_cycle = false;    ///< at the start of its first pattern
  TrackerOptions tracker = {};           ///< for triggers and bursts
  BurstOptions bursts = {};
  SignOptions signs = {};  ///< of triggers, looked at to find the pattern again after a loss

  int64_t origin_us = 0;  ///< kSchedule: when the first pattern of any cycle began

  /// Called with every batch that is read and every mark that is found, for pictures of a recording.
  std::function<void(const recordings::EventBatch&)> on_batch = {};
  std::function<void(const Mark&)> on_mark = {};

  std::optional<PixelFilterOptions> filter = {};  ///< hot and flickering pixels

  /// Events that may wait until their pattern is known; more than this and the oldest are given up.
  size_t max_waiting_events = size_t{1} << 26;
};

/// Times t with begin_us <= t < end_us.
struct TimeSlice {
  int64_t begin_us = 0;
  int64_t end_us = 0;
};

/// One pass over the patterns.
struct Cycle {
  uint64_t number = 0;            ///< in the recording, dropped ones counted
  int64_t begin_us = 0;           ///< start of its first pattern
  std::vector<TimeSlice> slices;  ///< of the event images
  capture::EventImages images;
  uint64_t events = 0;     ///< in the images
  uint64_t saturated = 0;  ///< events for which the images had no room
  /// That the patterns changed when they are said to, by the events; of the least certain one. 0 where the signs of the
  /// events contradict the schedule, or where a trigger is out of step.
  float confidence = 1.0F;
  CyclePolarity polarity = CyclePolarity::kUnknown;

  int64_t known_us = 0;  ///< how far the recording had been read when the cycle was complete
  /// When the bytes that completed it arrived; nothing for a recording that is not live. The time from the end of its
  /// last pattern to anything done with it is (known_us - slices.back().end_us) and the time since `arrival`.
  std::optional<std::chrono::steady_clock::time_point> arrival = {};
};

/// Why a cycle was dropped.
enum class CycleFault {
  kMissing,  ///< a transition was not seen
  kDoubled,  ///< a transition too many was seen
  kLost,     ///< the transitions left the schedule
  kPartial,  ///< the recording begins or ends within it
};
inline constexpr size_t kNumCycleFaults = 4;
[[nodiscard]] const char* cycle_fault_name(CycleFault fault);

struct DroppedCycle {
  uint64_t number = 0;
  int64_t begin_us = 0;
  int64_t fault_us = 0;
  CycleFault fault = CycleFault::kMissing;
};

struct CycleReport {
  uint64_t complete = 0;
  std::array<uint64_t, kNumCycleFaults> dropped{};
  std::vector<DroppedCycle> drops;   ///< the first kMaxDrops
  uint64_t marks = 0;                ///< triggers of the channel and edge, or bursts
  uint64_t unassigned_marks = 0;     ///< of them, those whose pattern could not be told
  bool has_assumed_first = false;    ///< intervals and events left open what the first trigger begins
  uint64_t events_given_up = 0;      ///< waited too long
  uint64_t hot_pixels = 0;           ///< that the filter silences now
  uint64_t inverted = 0;             ///< complete cycles whose events have the opposite signs
  uint64_t half_cycle_off = 0;       ///< complete cycles whose patterns are taken for their inverses
  std::vector<LateEdge> late_edges;  ///< the first kMaxDrops
  /// How long after the triggers the events of their patterns set in; see OnsetCheck::onset_us().
  std::optional<int64_t> onset_us;
  std::string triggers;  ///< survey_text()
  std::string advice;    ///< trigger_advice(); empty where the source is not triggers and cycles were found

  static constexpr size_t kMaxDrops = 1000;
};

/// Cuts a recording into cycles and accumulates each into event images. Memory is bounded by one cycle's images, one
/// batch and the events whose pattern is not known yet: a few milliseconds of them, or one cycle at the start.
class CycleReader {
 public:
  /// Fails with kInvalidValue: a schedule that is not valid, a first pattern that does not exist, a sensor of unknown
  /// size (give the reader one). With kAuto two cycles' time of the recording is read first, and what comes later
  /// waits.
  [[nodiscard]] static Result<CycleReader> open(std::unique_ptr<recordings::RecordingReader> reader,
                                                const CycleOptions& options);

  CycleReader(CycleReader&&) noexcept;
  CycleReader& operator=(CycleReader&&) noexcept;
  ~CycleReader();

  /// The next complete cycle; nothing at the end. Cycles that are not complete are dropped and reported.
  /// Fails as the reader does; under its strict policy also where an image has no room for an event.
  [[nodiscard]] Result<std::optional<Cycle>> next();

  [[nodiscard]] CycleReport report() const;

  /// What was left out: of the recording, and of the images of complete cycles.
  [[nodiscard]] recordings::DecodeSummary summary() const;

  /// What tells when patterns change; never kAuto.
  [[nodiscard]] CycleSource source() const;
  [[nodiscard]] const recordings::RecordingReader& recording() const;
  [[nodiscard]] const Schedule& schedule() const;

 private:
  class Impl;
  explicit CycleReader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace e2lf::cycles
