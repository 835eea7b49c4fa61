// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "e2lf/capture/measurement/hot_pixels.h"
#include "e2lf/cycles/cycle_reader.h"
#include "e2lf/diagnose/finding.h"
#include "e2lf/diagnose/triggers.h"
#include "e2lf/recordings/event_counters.h"

namespace e2lf::diagnose {

/// The polarity of a cycle according to its events.
enum class Polarity {
  kUnknown,       ///< the schedule states no signs, or there are too few events
  kRight,         ///< the signs are those of the schedule
  kInverted,      ///< ON and OFF are exchanged
  kHalfCycleOff,  ///< the patterns are mistaken for their inverses
};

/// Compares the events of a whole cycle, with one entry per pattern of the schedule, with the signs that the schedule
/// states. A display that shows each pattern and its inverse has the same intervals in both halves of its cycle, so
/// that inverted signs alone look like the other half. The strength distinguishes them: the changes after black cause
/// many times the events of the changes after white, because pixels respond to relative changes. Both criteria are
/// therefore combined.
[[nodiscard]] Polarity polarity_of(const cycles::Schedule& schedule, std::span<const cycles::PatternEvents> events);

/// Returns true if the events hardly confirm the times of a cycle with this confidence.
[[nodiscard]] bool is_doubtful(float confidence, cycles::CycleSource source);

/// Watches a recording while it is divided into cycles, and judges its triggers, its schedule, the polarity of its
/// events, and whether some are duplicates or of hot pixels.
class RigCheck {
 public:
  /// Adds the next batch; see cycles::CycleOptions::on_batch.
  void add(const recordings::EventBatch& batch);

  /// Adds the next complete cycle, and returns its confidence: that of the cycle, or 0 if the signs of its events
  /// contradict the schedule or if a trigger is out of step.
  float add(const cycles::Cycle& cycle, const cycles::CycleOptions& options);

  [[nodiscard]] float least_confidence() const { return least_confidence_; }

  /// Returns what may be wrong, the most certain reason first.
  [[nodiscard]] Findings findings(const cycles::CycleReader& reader) const;

  /// Returns the triggers found and expected in one line.
  [[nodiscard]] std::string triggers_text(const cycles::Schedule& schedule) const {
    return diagnose::triggers_text(inputs_, schedule);
  }

  /// Returns the time of the recording that was added.
  [[nodiscard]] int64_t seen_us() const { return last_us_ == INT64_MIN ? 0 : last_us_ - first_us_; }
  /// Returns the reason why the recording contains no complete cycle.
  [[nodiscard]] Finding no_cycle_finding(const cycles::CycleReader& reader) const;

  /// Returns the cycles that were found and dropped, and what may be wrong with the rig: {"complete", "dropped", ...,
  /// "triggers", "least_confidence", "event_delay_us", "findings"}.
  [[nodiscard]] Json json(const cycles::CycleReader& reader) const;

 private:
  void add_light(const cycles::Cycle& cycle);
  [[nodiscard]] uint64_t cycles_of(Polarity polarity) const { return polarities_[static_cast<size_t>(polarity)]; }
  /// live decodes most cycles only as far as their event images require, so that their signs are not known.
  [[nodiscard]] uint64_t cycles_of_known_signs() const {
    return cycles_of(Polarity::kRight) + cycles_of(Polarity::kInverted) + cycles_of(Polarity::kHalfCycleOff);
  }
  [[nodiscard]] std::optional<Finding> check_light() const;
  [[nodiscard]] std::optional<Finding> check_inversion(const cycles::CycleOptions& options) const;
  [[nodiscard]] std::optional<Finding> check_halves(const cycles::CycleOptions& options) const;
  [[nodiscard]] std::optional<Finding> check_late_triggers(const cycles::Schedule& schedule) const;
  [[nodiscard]] std::optional<Finding> check_delay(const cycles::CycleOptions& options) const;
  [[nodiscard]] std::optional<Finding> check_confidence() const;
  [[nodiscard]] std::optional<Finding> check_pixels() const;
  [[nodiscard]] std::optional<Finding> check_duplicates() const;

  TriggerInputs inputs_;
  EventDelay delay_;
  LateTriggerFinder late_;
  std::vector<LateTrigger> late_triggers_;  ///< the first ones
  uint64_t num_late_ = 0;
  int64_t first_us_ = INT64_MAX, last_us_ = INT64_MIN;
  Polarity polarity_ = Polarity::kUnknown;  ///< of the last cycle all of whose events were read
  std::array<uint64_t, 4> polarities_{};    ///< number of such cycles
  std::vector<double> signed_per_pixel_;    ///< ON less OFF events of each pattern, summed over such cycles
  uint64_t cycles_ = 0, doubtful_ = 0;
  capture::CountSums sums_;  ///< of the first cycles
  size_t num_hot_ = 0;
  recordings::DuplicateCounter duplicates_;
  uint64_t batches_ = 0;
  float least_confidence_ = 1.0F;
};

/// Returns what may be wrong with a camera from the events and triggers that it sent during an observation.
[[nodiscard]] Findings check_camera(const recordings::RecordingReader& camera, uint64_t events, uint64_t triggers,
                                    double seconds);
[[nodiscard]] Finding no_trigger_finding(double seconds);

}  // namespace e2lf::diagnose
