// SPDX-License-Identifier: MIT
#include "e2lf/pipeline/cycle_input.h"

#include <algorithm>
#include <cstdlib>

#include "e2lf/base/text.h"

namespace e2lf::pipeline {
namespace {

void invert(capture::EventImages& images) {
  for (int16_t& count : images.values) count = capture::saturated(-count);
}

Result<void> check(const CycleInputOptions& options) {
  if (options.max_cycles == 0 || options.max_cycles >= options.cycles_per_field) return {};
  return fail(ErrorCode::kInvalidValue, options.input, "a light field takes ", options.cycles_per_field,
              " cycles, but at most ", options.max_cycles, " may be read; raise this limit")
      .about("max_cycles");
}

Error too_few_error(size_t cycles, const CycleInputOptions& options) {
  return fail(ErrorCode::kInvalidValue, options.input, "there are ", cycles, " cycles, fewer than the ",
              options.cycles_per_field, " of one sum; reduce their number")
      .about("cycles_per_field");
}

/// Returns true if the event images cannot be those of a whole cycle of N patterns, which has 2N transitions.
bool is_without_whole_cycle(const capture::MeasurementFile& file) {
  const size_t transitions = file.cycles.front().events.count;
  const auto& codes = file.setup.codes;
  const bool is_lit = codes && codes->num_patterns == transitions + 1 && !capture::codes_of_whole_cycle(*codes);
  return is_lit || transitions % 2 != 0;
}

Result<void> check(const capture::MeasurementFile& file, const CycleInputOptions& options) {
  const capture::MeasurementKind measured = file.cycles.front().kind;
  const auto useless = [&](const std::string& why, const char* option) {
    return fail(ErrorCode::kInvalidValue, options.input, why, "; omit this option").about(option);
  };
  if (options.cycles_per_field > 1 && measured != capture::MeasurementKind::kEventImages) {
    return useless(
        cat("only event images can be summed; this is the measurement ", capture::measurement_name(measured)),
        "cycles_per_field");
  }
  if (file.cycles.size() < options.cycles_per_field) return too_few_error(file.cycles.size(), options);
  if (options.cycles.invert_polarity && !capture::has_events(measured)) {
    return useless("this measurement has no events", "invert_polarity");
  }
  if (options.schedule.transitions == "all" && is_without_whole_cycle(file)) {
    return fail(ErrorCode::kInvalidValue, options.input,
                "these are not the event images of all transitions; accumulate the recording with all of them, or "
                "omit this option")
        .about("transitions");
  }
  return {};
}

bool is_empty(const capture::Measurement& cycle) {
  return capture::has_events(cycle.kind) && capture::is_without_events(cycle.events);
}

double behind_s(const cycles::Cycle& cycle) {
  if (!cycle.arrival) return 0;
  return static_cast<double>(std::max<int64_t>(0, cycle.known_us - cycle.slices.back().end_us)) * 1e-6;
}

}  // namespace

uint64_t add_counts(const capture::EventImages& more, capture::EventImages& sum) {
  uint64_t saturated = 0;
  for (size_t i = 0; i < sum.values.size(); ++i) {
    const int count = sum.values[i] + more.values[i];
    sum.values[i] = capture::saturated(count);
    saturated += static_cast<uint64_t>(std::abs(count - sum.values[i]));
  }
  return saturated;
}

Result<CycleInput> CycleInput::open(EventSource source, CycleInputOptions options) {
  E2LF_RETURN_IF_ERROR(check(options));
  CycleInput input(std::move(options));
  if (auto* file = std::get_if<capture::MeasurementFile>(&source)) {
    E2LF_RETURN_IF_ERROR(input.take(std::move(*file)));
    return input;
  }
  CycleInputOptions observed = input.options_;
  observed.cycles.on_batch = [rig = input.rig_, next = input.options_.cycles.on_batch](const auto& batch) {
    rig->add(batch);
    if (next) next(batch);
  };
  auto& recording = std::get<std::unique_ptr<recordings::RecordingReader>>(source);
  E2LF_ASSIGN_OR_RETURN(input.reader_, open_cycles(std::move(recording), observed));
  return input;
}

Result<void> CycleInput::take(capture::MeasurementFile file) {
  E2LF_RETURN_IF_ERROR(check(file, options_));
  has_one_field_ = file.cycles.size() / options_.cycles_per_field == 1;
  if (options_.max_cycles != 0 && options_.max_cycles < file.cycles.size()) file.cycles.resize(options_.max_cycles);
  if (options_.cycles.invert_polarity) {
    for (capture::Measurement& cycle : file.cycles) invert(cycle.events);
  }
  file_ = std::move(file);
  return {};
}

Result<std::optional<CycleImages>> CycleInput::next_cycle() {
  CycleImages next;
  if (!reader_) {
    if (taken_ == file_.cycles.size()) return std::optional<CycleImages>();
    next.images = std::move(file_.cycles[taken_++]);
    next.without_events = is_empty(next.images) ? 1 : 0;
    return std::optional(std::move(next));
  }
  if (options_.max_cycles != 0 && taken_ == options_.max_cycles) return std::optional<CycleImages>();
  E2LF_ASSIGN_OR_RETURN(next.cycle, reader_->next());
  if (!next.cycle) return std::optional<CycleImages>();
  ++taken_;
  next.source = reader_->source();
  next.cycle->confidence = rig_->add(*next.cycle, reader_->options());
  next.ready = next.cycle->arrival.value_or(CycleClock::now());
  next.behind_s = behind_s(*next.cycle);
  next.images = std::move(next.cycle->images);
  next.without_events = is_empty(next.images) ? 1 : 0;
  return std::optional(std::move(next));
}

recordings::DecodeSummary CycleInput::summary() const {
  recordings::DecodeSummary summary = reader_ ? reader_->summary() : recordings::DecodeSummary();
  summary.saturated += saturated_;
  summary.left_over_cycles += left_over_;
  return summary;
}

Result<std::optional<CycleImages>> CycleInput::next() {
  E2LF_ASSIGN_OR_RETURN(std::optional<CycleImages> sum, next_cycle());
  for (size_t cycle = 1; sum && cycle < options_.cycles_per_field; ++cycle) {
    E2LF_ASSIGN_OR_RETURN(std::optional<CycleImages> more, next_cycle());
    if (!more) {
      if (taken_ == cycle) return too_few_error(cycle, options_);
      left_over_ = cycle;
      return std::optional<CycleImages>();
    }
    const uint64_t saturated = add_counts(more->images.events, sum->images.events);
    saturated_ += saturated;
    if (saturated > 0 && options_.is_strict) return recordings::saturation_error(saturated, "cycles");
    if (more->cycle) more->cycle->confidence = std::min(more->cycle->confidence, sum->cycle->confidence);
    more->without_events += sum->without_events;
    more->images = std::move(sum->images);
    sum = std::move(more);
  }
  if (sum && fusion_) {
    fusion_->add(sum->images.events);
    sum->images.fused = fusion_->fused();
  }
  return sum;
}

Result<void> CycleInput::fuse(const capture::SensorProfile& camera, size_t most_cycles) {
  if (measurement() != capture::MeasurementKind::kEventImages) {
    return fail(ErrorCode::kInvalidValue, options_.input, "only event images can be fused; this is the measurement ",
                capture::measurement_name(measurement()), "; omit this option")
        .about("fuse");
  }
  if (options_.cycles_per_field > 1) {
    return fail(ErrorCode::kInvalidValue, options_.input,
                "the cycles of a light field are summed already; omit this option")
        .about("fuse");
  }
  fusion_.emplace(camera, most_cycles);
  return {};
}

Result<void> CycleInput::check_transitions() const {
  if (reader_ || options_.schedule.transitions != "lit") return {};
  return fail(ErrorCode::kInvalidValue, options_.input,
              "the lit transitions are selected in recordings and not in event images; omit this option")
      .about("transitions");
}

bool CycleInput::is_without_events() const {
  return !reader_ && std::ranges::all_of(file_.cycles, is_empty);
}

namespace {

/// Returns true if the events of all transitions are used. Unless a network determines this, the patterns of the
/// recording do.
bool uses_all_transitions(const ScheduleChoice& choice, const cycles::Schedule& schedule, bool is_recorded_whole) {
  if (choice.transitions != "auto") return choice.transitions == "all";
  if (choice.num_wanted == schedule.num_images() + 1) return false;
  return is_recorded_whole || choice.num_wanted == schedule.size() + 1;
}

Result<cycles::Schedule> choose_schedule(const ScheduleChoice& choice, const std::filesystem::path& recording,
                                         const recordings::RecordingInfo& info) {
  constexpr size_t kFewest = 2;
  E2LF_ASSIGN_OR_RETURN(const capture::RecordedSetup setup, recorded_setup(recording, info));
  const auto of_whole = setup.codes ? capture::codes_of_whole_cycle(*setup.codes) : std::nullopt;
  const auto& shown = of_whole ? of_whole : setup.codes;
  const size_t recorded = shown ? std::max(shown->num_patterns, kFewest) : choice.usual_patterns;
  cycles::Schedule schedule =
      choice.schedule ? *choice.schedule : cycles::paper_schedule(choice.num_patterns.value_or(recorded));
  if (!uses_all_transitions(choice, schedule, of_whole.has_value())) return schedule;
  return with_all_transitions(std::move(schedule));
}

Result<void> choose_source(cycles::CycleOptions& options, const std::optional<int64_t>& origin_us) {
  using cycles::CycleSource;
  const bool has_triggers = options.one_trigger_per_cycle || options.channel;
  if (options.source == CycleSource::kAuto) {
    options.source = has_triggers ? CycleSource::kTriggers : origin_us ? CycleSource::kSchedule : CycleSource::kAuto;
  }
  if (has_triggers && options.source != CycleSource::kTriggers) {
    return fail(ErrorCode::kInvalidValue, "", "the source of the cycles is not the triggers; omit what describes them")
        .about(options.channel ? "channel" : "one_trigger_per_cycle");
  }
  if (origin_us && options.source != CycleSource::kSchedule) {
    return fail(ErrorCode::kInvalidValue, "", "the source of the cycles is not the schedule; omit when a cycle began")
        .about("origin_us");
  }
  if (options.source == CycleSource::kSchedule && !origin_us) {
    return fail(ErrorCode::kInvalidValue, "",
                "the schedule does not state when a cycle began; give that time, or use the events as the source")
        .about("origin_us");
  }
  options.origin_us = origin_us.value_or(0);
  return {};
}

}  // namespace

Result<cycles::CycleReader> open_cycles(std::unique_ptr<recordings::RecordingReader> recording,
                                        const CycleInputOptions& options) {
  cycles::CycleOptions cycles = options.cycles;
  E2LF_ASSIGN_OR_RETURN(cycles.schedule, choose_schedule(options.schedule, options.input, recording->info()));
  E2LF_RETURN_IF_ERROR(choose_source(cycles, options.origin_us));
  return cycles::CycleReader::open(std::move(recording), cycles);
}

}  // namespace e2lf::pipeline
