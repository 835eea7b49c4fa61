// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/event_run.h"

#include <algorithm>
#include <numeric>

#include "e2lf/base/text.h"
#include "e2lf/diagnose/event_images.h"
#include "e2lf/diagnose/event_order.h"

namespace e2lf::pipeline {
namespace {

Result<void> check_input(const CycleInput& input, const CycleInputOptions& options) {
  if (input.is_without_events()) {
    return fail(ErrorCode::kInvalidValue, options.input,
                "there are no events to reconstruct from: all counts are 0; check how they were accumulated");
  }
  return input.check_transitions();
}

}  // namespace

std::optional<double> EventResult::fused_cycles() const {
  const auto& cycles = cycle.images.fused.cycles.values;
  if (cycles.empty()) return std::nullopt;
  return std::reduce(cycles.begin(), cycles.end(), 0.0) / static_cast<double>(cycles.size());
}

ScheduleChoice wanted_schedule(ScheduleChoice schedule, const MethodChoice& method) {
  if (method.model) {
    schedule.num_wanted = method.model->num_patterns;
  } else if (method.codes) {
    schedule.num_wanted = method.codes->num_patterns;
  }
  const auto& codes = method.codes || !method.model ? method.codes : method.model->codes;
  if (codes && codes->num_patterns >= 2) {
    schedule.usual_patterns = capture::codes_of_whole_cycle(*codes).value_or(*codes).num_patterns;
  }
  return schedule;
}

Result<EventRun> EventRun::open(EventSource source, EventRunOptions options) {
  options.events.cycles_per_field = options.method.use.cycles;
  options.events.schedule = wanted_schedule(std::move(options.events.schedule), options.method);
  E2LF_ASSIGN_OR_RETURN(CycleInput input, CycleInput::open(std::move(source), options.events));
  E2LF_RETURN_IF_ERROR(check_input(input, options.events));
  EventRun run(std::move(options), std::move(input));
  E2LF_RETURN_IF_ERROR(run.open_method_of_input());
  if (run.method_.gives_disparities()) return run;
  E2LF_ASSIGN_OR_RETURN(run.sequence_, open_sequence(run.method_, run.options_.tone));
  E2LF_ASSIGN_OR_RETURN(run.check_, FieldCheck::create(run.method_, run.method_.use.cycles));
  return run;
}

Result<void> EventRun::open_method_of_input() {
  MethodChoice choice = std::move(options_.method);
  choice.measurement = input_.measurement();
  choice.transitions = input_.transitions();
  choice.lit_where_moving = choice.algorithm != Algorithm::kDepth && options_.events.schedule.transitions == "auto";
  if (input_.is_recording()) choice.schedule = &input_.reader().schedule();
  E2LF_ASSIGN_OR_RETURN(choice.events, input_.setup());
  E2LF_ASSIGN_OR_RETURN(method_, naming(options_.events.input, open_method(std::move(choice))));
  if (method_.use.fused_cycles > 1) E2LF_RETURN_IF_ERROR(input_.fuse(method_.sensor(), method_.use.fused_cycles));
  views_ = method_.views;
  if (!options_.turned.is_upright()) views_ = views_.value_or(capture::Orientation{}) + options_.turned;
  return {};
}

Result<std::optional<EventResult>> EventRun::next(const ProgressFn& progress) {
  E2LF_ASSIGN_OR_RETURN(std::optional<CycleImages> cycle, input_.next());
  if (!cycle) return std::optional<EventResult>();
  if (progress) progress(0, 1);
  EventResult result{.number = made_, .cycle = std::move(*cycle)};
  const auto& of_recording = result.cycle.cycle;
  result.is_confirmed =
      method_.is_confirmed && !(of_recording && diagnose::is_doubtful(of_recording->confidence, result.cycle.source));
  if (capture::has_events(result.cycle.images.kind)) result.findings = judge_events(result);
  const auto is_error = [](const diagnose::Finding& each) { return each.severity == diagnose::Severity::kError; };
  if (std::ranges::any_of(result.findings, is_error)) result.is_confirmed = false;
  E2LF_RETURN_IF_ERROR(naming(options_.events.input, make(result, progress)));
  keep(result);
  return std::optional(std::move(result));
}

Result<void> EventRun::make(EventResult& result, const ProgressFn& progress) {
  switch (method_.algorithm) {
    case Algorithm::kNetwork:
    case Algorithm::kInversion:
      return make_light_field(result, progress);
    case Algorithm::kDepth:
      return make_map(result, progress);
  }
  return {};
}

diagnose::Findings EventRun::judge_events(const EventResult& result) const {
  const capture::EventImages& events = result.cycle.images.events;
  const size_t cycles = method_.use.cycles;
  diagnose::Findings findings = diagnose::check_event_images(events, cycles);
  if (const size_t empty = result.cycle.without_events; empty > 0 && empty < cycles) {
    findings.push_back({"events-absent",
                        diagnose::Severity::kError,
                        cat(empty, " of the ", cycles, " cycles of the sum have no events, so that it is too dark"),
                        "check the camera and the display, or sum fewer cycles",
                        {{"cycles", empty}}});
  }
  // Wrong times explain every other sign and order, and so do wrong signs and orders other places of the patterns.
  if (made_ > 0 || !result.is_confirmed || diagnose::has_doubt(findings)) return findings;
  auto other = diagnose::check_order(events, cycles, method_.known_setup());
  if (!other && are_patterns_stated(method_.codes)) {
    other = diagnose::check_places(events, method_.codes->codes, method_.camera, views_);
  }
  if (other && other->severity != diagnose::Severity::kNote) findings.push_back(*std::move(other));
  return findings;
}

Result<void> EventRun::make_light_field(EventResult& result, const ProgressFn& progress) {
  const auto compare = [&](const lightfield::LightField& unprocessed, const capture::Measurement& used,
                           bool is_of_lit) -> Result<void> {
    if (!check_ || !capture::has_events(used.kind)) return {};
    E2LF_ASSIGN_OR_RETURN(result.error, check_->compare(unprocessed, used.events, is_of_lit));
    if (made_ > 0) return {};
    E2LF_ASSIGN_OR_RETURN(result.check, check_->judge(unprocessed, used.events, is_of_lit));
    // Light fields for other patterns can explain the events as well.
    result.is_confirmed = result.is_confirmed && are_patterns_stated(method_.codes);
    return {};
  };
  const bool finds_gain = !sequence_->tone().gain;
  E2LF_ASSIGN_OR_RETURN(result.made, sequence_->next(result.cycle.images, progress, compare));
  if (const auto& gain = sequence_->tone().gain; finds_gain && gain) {
    if (auto unusual = gain_finding(method_, *gain)) result.findings.push_back(std::move(*unusual));
  }
  return {};
}

Result<void> EventRun::make_map(EventResult& result, const ProgressFn& progress) {
  E2LF_ASSIGN_OR_RETURN(result.made, depth_of_events(method_, result.cycle.images, method_.use.cycles,
                                                     views_.value_or(capture::Orientation{}), progress));
  const depth::DisparityMap& map = std::get<EventDepth>(result.made).map;
  for (auto finding : {range_finding(method_.network->model(), map), confidence_finding(map)}) {
    if (finding) result.findings.push_back(*std::move(finding));
  }
  return {};
}

void EventRun::keep(const EventResult& result) {
  ++made_;
  if (const auto* field = std::get_if<Field>(&result.made)) of_lit_ += field->is_of_lit ? 1 : 0;
  const auto add = [this](const diagnose::Findings& findings) {
    for (const diagnose::Finding& finding : findings) {
      if (!diagnose::contains(of_results_, finding.code)) of_results_.push_back(finding);
    }
  };
  add(result.findings);
  if (result.check) add(result.check->findings);
}

EventRunReport EventRun::report() const {
  EventRunReport report{
      .results = made_, .of_lit = of_lit_, .left_out = input_.summary(), .findings = method_.findings};
  if (sequence_) report.tone = sequence_->tone();
  const auto add = [&](const diagnose::Findings& findings) {
    report.findings.insert(report.findings.end(), findings.begin(), findings.end());
  };
  if (input_.is_recording()) add(input_.rig().findings(input_.reader()));
  add(of_results_);
  return report;
}

}  // namespace e2lf::pipeline
