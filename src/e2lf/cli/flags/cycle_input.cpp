// SPDX-License-Identifier: MIT
#include "e2lf/cli/flags/cycle_input.h"

#include <algorithm>
#include <cstdlib>

#include "e2lf/base/text.h"
#include "e2lf/capture/measurement/plausible_events.h"
#include "e2lf/cli/flags/file_kind.h"
#include "e2lf/cli/output/live_log.h"

namespace e2lf::cli {
namespace {

/// Returns how many events there is no room for.
uint64_t add(const capture::EventImages& more, capture::EventImages& sum) {
  uint64_t saturated = 0;
  for (size_t i = 0; i < sum.counts.size(); ++i) {
    const int count = sum.counts[i] + more.counts[i];
    sum.counts[i] = static_cast<int16_t>(std::clamp(count, INT16_MIN, INT16_MAX));
    saturated += static_cast<uint64_t>(std::abs(count - sum.counts[i]));
  }
  return saturated;
}

void invert(capture::EventImages& images) {
  for (int16_t& count : images.counts) count = static_cast<int16_t>(std::min(-count, INT16_MAX));
}

}  // namespace

Result<std::optional<CycleImages>> CycleInput::next_cycle() {
  CycleImages next;
  if (!reader_) {
    if (taken_ == file_.cycles.size()) return std::optional<CycleImages>();
    next.images = std::move(file_.cycles[taken_++]);
    return std::optional(std::move(next));
  }
  if (max_cycles_ != 0 && taken_ == max_cycles_) return std::optional<CycleImages>();
  E2LF_ASSIGN_OR_RETURN(std::optional<cycles::Cycle> cycle, reader_->next());
  if (!cycle) return std::optional<CycleImages>();
  ++taken_;
  confidence_.add(*cycle, reader_->source());
  next.about = cycle_json(*cycle);
  next.ready = cycle->arrival.value_or(CycleClock::now());
  next.behind_s = behind_s(*cycle);
  next.is_live = cycle->arrival.has_value();
  next.images = std::move(cycle->images);
  return std::optional(std::move(next));
}

recordings::DecodeSummary CycleInput::summary() const {
  recordings::DecodeSummary summary = reader_ ? reader_->summary() : recordings::DecodeSummary();
  summary.saturated += saturated_;
  return summary;
}

Result<std::optional<CycleImages>> CycleInput::next() {
  E2LF_ASSIGN_OR_RETURN(std::optional<CycleImages> sum, next_cycle());
  for (size_t cycle = 1; sum && cycle < cycles_per_field_; ++cycle) {
    E2LF_ASSIGN_OR_RETURN(std::optional<CycleImages> more, next_cycle());
    if (!more) return std::optional<CycleImages>();
    const uint64_t saturated = add(more->images.events, sum->images.events);
    saturated_ += saturated;
    if (saturated > 0 && is_strict_) return recordings::saturation_error(saturated, "--cycles-per-field");
    more->images = std::move(sum->images);
    sum = std::move(more);
  }
  return sum;
}

bool CycleInput::is_without_events() const {
  const auto is_empty = [](const capture::Measurement& cycle) { return capture::is_without_events(cycle.events); };
  return !reader_ && capture::has_events(measurement()) &&
         std::all_of(file_.cycles.begin(), file_.cycles.end(), is_empty);
}

Result<CycleInput> open_cycle_input(const std::filesystem::path& input, const CycleFlags& flags,
                                    size_t cycles_per_field, const Verb& verb) {
  if (flags.max_cycles != 0 && flags.max_cycles < cycles_per_field) {
    return Error{ErrorCode::kInvalidValue,
                 cat("a light field takes the ", cycles_per_field, " cycles of --cycles-per-field; ask for as many"),
                 cat("--max-cycles ", flags.max_cycles)};
  }
  E2LF_ASSIGN_OR_RETURN(const FileKind kind, file_kind(input));
  if (kind == FileKind::kRecording) {
    E2LF_ASSIGN_OR_RETURN(cycles::CycleReader reader, open_cycles(input, flags));
    return CycleInput(std::move(reader), flags, cycles_per_field);
  }
  if (kind != FileKind::kEventImages && kind != FileKind::kImages) {
    return other_kind_error(input, kind, "a recording or event images");
  }
  E2LF_RETURN_IF_ERROR(verb.refuse_options(kCycleOptions, kind_text(kind)));
  E2LF_ASSIGN_OR_RETURN(capture::MeasurementFile file, capture::read_measurements(input));
  const capture::MeasurementKind measured = file.cycles.front().kind;
  if (cycles_per_field > 1 && measured != capture::MeasurementKind::kEventImages) {
    return Error{ErrorCode::kInvalidValue,
                 cat("sums are of event images; this is the measurement ", capture::measurement_name(measured),
                     "; leave the option out"),
                 "--cycles-per-field"};
  }
  if (file.cycles.size() < cycles_per_field) {
    return Error{ErrorCode::kInvalidValue,
                 cat("there are ", file.cycles.size(), " cycles, fewer than the ", cycles_per_field,
                     " of --cycles-per-field; ask for fewer"),
                 input.string()};
  }
  if (flags.invert_polarity) {
    if (!capture::has_events(measured)) {
      return Error{ErrorCode::kInvalidValue, "this measurement has no events; leave the option out",
                   "--invert-polarity"};
    }
    for (capture::Measurement& cycle : file.cycles) invert(cycle.events);
  }
  return CycleInput(std::move(file), flags, cycles_per_field);
}

}  // namespace e2lf::cli
