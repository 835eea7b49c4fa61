// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <variant>

#include "e2lf/base/progress.h"
#include "e2lf/base/result.h"
#include "e2lf/diagnose/rig.h"
#include "e2lf/pipeline/cycle_input.h"
#include "e2lf/pipeline/event_depth.h"
#include "e2lf/pipeline/field_check.h"
#include "e2lf/pipeline/field_sequence.h"
#include "e2lf/pipeline/method.h"

namespace e2lf::pipeline {

struct EventRunOptions {
  CycleInputOptions events = {};  ///< the number of cycles of each result is that of `method.use`
  /// What the caller specifies. The setup of the events, the kind of measurement and the number of transitions follow
  /// from the events. The algorithm determines what the run makes: light fields, or disparity maps.
  MethodChoice method = {};
  Tone tone = {};                    ///< of light fields
  capture::Orientation turned = {};  ///< is added to the orientation of the views that the events state
};

/// What a run makes of the events of one cycle, or of the sum over several.
struct EventResult {
  size_t number = 0;  ///< counts the results of the run from 0
  CycleImages cycle = {};
  std::variant<Field, EventDepth> made = {};
  diagnose::Findings findings = {};  ///< of its event images, of the first ones' signs and order, and of the gain
  std::optional<recon::EventError> error = {};  ///< of a light field, if the patterns are known
  std::optional<Explanation> check = {};        ///< of the first light field
  bool is_confirmed = true;                     ///< whether the times and patterns are confirmed
  /// Returns the mean over the pixels of the number of cycles that were fused, or nothing if none were.
  [[nodiscard]] std::optional<double> fused_cycles() const;
};

/// What is known of a run so far.
struct EventRunReport {
  size_t results = 0, of_lit = 0;  ///< number of results, and of those from the lit transitions alone
  Tone tone = {};                  ///< of all light fields
  recordings::DecodeSummary left_out = {};
  /// What may be wrong: as the file of the events states, with the method, with the recording, and with the results,
  /// of which each code appears once.
  diagnose::Findings findings = {};
};

/// One run from events to light fields or disparity maps: it divides a recording into cycles, chooses the method, sums
/// and fuses cycles, uses the lit transitions where the scene moves, and judges the input and the results.
class EventRun {
 public:
  /// Fails with kInvalidValue if all counts of a file are 0 or if an option does not apply to the events (the error
  /// names it), and as CycleInput::open(), CycleInput::setup() and open_method() do.
  [[nodiscard]] static Result<EventRun> open(EventSource source, EventRunOptions options);

  /// Returns the next result, or nothing at the end. `progress` begins with (0, 1) when the events of the cycle are
  /// complete. Fails as CycleInput::next() and the method do.
  [[nodiscard]] Result<std::optional<EventResult>> next(const ProgressFn& progress = {});

  [[nodiscard]] EventRunReport report() const;
  [[nodiscard]] const OpenedMethod& method() const { return method_; }
  /// Returns the orientation in which the views are made, or nothing if neither the caller nor the events state one.
  [[nodiscard]] const std::optional<capture::Orientation>& views() const { return views_; }
  [[nodiscard]] const CycleInput& input() const { return input_; }

 private:
  EventRun(EventRunOptions options, CycleInput input) : options_(std::move(options)), input_(std::move(input)) {}
  [[nodiscard]] Result<void> open_method_of_input();
  [[nodiscard]] Result<void> make(EventResult& result, const ProgressFn& progress);
  [[nodiscard]] diagnose::Findings judge_events(const EventResult& result) const;
  [[nodiscard]] Result<void> make_light_field(EventResult& result, const ProgressFn& progress);
  [[nodiscard]] Result<void> make_map(EventResult& result, const ProgressFn& progress);
  void keep(const EventResult& result);

  EventRunOptions options_;
  CycleInput input_;
  OpenedMethod method_;
  std::optional<capture::Orientation> views_;
  std::optional<FieldSequence> sequence_;  ///< of light fields
  std::optional<FieldCheck> check_;
  diagnose::Findings of_results_;
  size_t made_ = 0, of_lit_ = 0;
};

/// Returns the choice of a schedule with the number of patterns that the model or the patterns of the caller need.
[[nodiscard]] ScheduleChoice wanted_schedule(ScheduleChoice schedule, const MethodChoice& method);

}  // namespace e2lf::pipeline
